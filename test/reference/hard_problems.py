"""Seeded problems that are badly scaled, rank-deficient, duplicated, near singular or infeasible.

Every problem draws one to three defects of its tasks and one kind of bounds, listed in its name.
One in five has general rows as well; every fourth stands on four point contacts. Nothing is
promised about conditioning.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from reference.plain import Array, Contacts, Level, Plain, Rows
from reference.problems import point_contacts, random_mass

TASKS = (
    "scaled_rows",  # rows times 10^[-4, 4], half of the time with their targets
    "rank_deficient",  # a row that is a multiple of another of its task
    "duplicate",  # a task twice, with the same target
    "conflict",  # a task twice, with another target
    "partly_dependent",  # a row made of rows of a level above
    "zero_row",
    "near_parallel",  # a row of a level above, turned by 1e-12 to 1e-3
    "near_singular",  # least singular value times 10^[-10, -1]
)
BOUNDS = (
    "none",
    "wide",
    "tight",  # 10^[-6, -1] of what the tasks want
    "flat",  # some bounds equal: no interior
    "one_sided",
    "mixed_scale",  # widths times 10^[-4, 4]
    "accelerations_conflict",  # acceleration box unreachable for the torques
    "empty_box",  # lower above upper
)
_SIZES = (2, 4, 7, 12, 17, 26, 32)


def hard_problems(count: int, seed: int = 11) -> Iterator[tuple[str, Plain]]:
    """`count` names and problems; every one has its own stream."""
    for index in range(count):
        rng = np.random.default_rng([seed, index])
        in_contact = index % 4 == 3
        n = 6 + int(rng.choice(_SIZES[3:])) if in_contact else int(rng.choice(_SIZES))
        defects = rng.choice(TASKS, size=int(rng.integers(1, 4)), replace=False)
        bounds = BOUNDS[int(rng.integers(len(BOUNDS)))]
        scale = 10 ** rng.uniform(-3, 3) if rng.random() < 0.3 else 1.0
        words = [*sorted(defects), bounds]
        words += ["contacts"] if in_contact else []
        words += ["scaled_mass"] if scale != 1.0 else []
        problem = _problem(rng, n, list(defects), bounds, scale, in_contact)
        yield " ".join(words), problem


def _problem(
    rng: np.random.Generator,
    n: int,
    defects: list[str],
    bounds: str,
    scale: float,
    in_contact: bool,
) -> Plain:
    mass, bias = scale * random_mass(rng, n), scale * rng.normal(size=n)
    levels = _levels(rng, n, defects)
    inside, force = 0.1 * rng.normal(size=n), np.zeros(0)
    u, contacts = (6, None) if in_contact else (0, None)
    if in_contact:
        contacts, force = _contacts(rng, n, inside)
        bias[:6] = contacts.force_jacobian.T[:6] @ force - mass[:6] @ inside
    wide, free = np.full(n, np.inf), np.full(n - u, np.inf)
    problem = Plain(levels, mass, bias, -wide, wide, -free, free, None, contacts, u)
    return _bounded(rng, problem, bounds, inside, force)


def _contacts(rng: np.random.Generator, n: int, inside: Array) -> tuple[Contacts, Array]:
    contacts, force = point_contacts(rng, n, 4)
    drift = contacts.jacobian @ inside
    return contacts._replace(drift=drift), force


def _levels(rng: np.random.Generator, n: int, defects: list[str]) -> tuple[Level, ...]:
    k = int(rng.integers(2, 9))
    levels: list[Level] = []
    for index in range(k):
        if index == k - 1 and rng.random() < 0.5:
            levels.append(Level(np.eye(n), rng.normal(size=n)))
            break
        m = int(rng.integers(1, min(6, n) + 1))
        level = Level(rng.normal(size=(m, n)), rng.normal(size=m) * 10 ** rng.uniform(-1, 1))
        for defect in defects:
            if rng.random() < 0.6:
                level = _spoiled(rng, level, levels, defect)
        levels.append(level)
    return tuple(levels)


def _spoiled(rng: np.random.Generator, level: Level, above: list[Level], defect: str) -> Level:
    """The level with one defect, or unchanged where it needs a level above."""
    jacobian, target = level.jacobian.copy(), level.target.copy()
    m, n = jacobian.shape
    other = above[int(rng.integers(len(above)))] if above else None
    if defect == "scaled_rows":
        scale = 10 ** rng.uniform(-4, 4, size=m)
        jacobian *= scale[:, None]
        target *= scale if rng.random() < 0.5 else 1.0
    elif defect == "rank_deficient" and m > 1:
        jacobian[-1] = rng.normal() * jacobian[0]
    elif defect == "zero_row":
        jacobian[int(rng.integers(m))] = 0.0
    elif defect == "near_singular":
        left, sigma, right = np.linalg.svd(jacobian, full_matrices=False)
        sigma[-1] *= 10 ** rng.uniform(-10, -1)
        jacobian = left @ (sigma[:, None] * right)
    elif other is not None and defect == "duplicate":
        return other
    elif other is not None and defect == "conflict":
        return Level(other.jacobian, rng.normal(size=len(other.target)))
    elif other is not None and defect == "partly_dependent":
        jacobian[0] = rng.normal(size=len(other.target)) @ other.jacobian
    elif other is not None and defect == "near_parallel":
        turn = 10 ** rng.uniform(-12, -3)
        jacobian[0] = other.jacobian[0] + turn * rng.normal(size=n)
    return Level(jacobian, target)


def _bounded(
    rng: np.random.Generator, problem: Plain, bounds: str, inside: Array, force: Array
) -> Plain:
    n, a = len(inside), len(problem.torque_lower)
    center = problem.torque(inside, force)
    half = np.ones(n)
    torque = np.abs(problem.mass[n - a :]) @ np.ones(n) + 1e-3
    if bounds == "none":
        return problem
    if bounds == "wide":
        half, torque = 10.0 * half, 10.0 * torque
    elif bounds == "tight":
        half, torque = 10 ** rng.uniform(-6, -1) * half, 10 ** rng.uniform(-6, -1) * torque
    elif bounds == "flat":
        half = np.where(rng.random(n) < 0.2, 0.0, half)
        torque = np.where(rng.random(a) < 0.2, 0.0, torque)
    elif bounds == "mixed_scale":
        half = 10 ** rng.uniform(-4, 4, size=n)
        torque = torque * 10 ** rng.uniform(-4, 4, size=a)
    lower, upper = inside - half, inside + half
    if rng.random() < 0.2:
        problem = problem._replace(rows=_general(rng, inside))
    if bounds == "one_sided":
        lower = np.where(rng.random(n) < 0.5, -np.inf, lower)
    elif bounds == "accelerations_conflict":
        lower, upper = inside + 20.0, inside + 21.0
        torque = 0.1 * torque
    elif bounds == "empty_box":
        j = int(rng.integers(n))
        lower[j], upper[j] = inside[j] + 10 ** rng.uniform(-8, 0), inside[j]
    return problem._replace(
        lower=lower, upper=upper, torque_lower=center - torque, torque_upper=center + torque
    )


def _general(rng: np.random.Generator, inside: Array) -> Rows:
    """Badly scaled rows that the known point meets, two of them nearly parallel."""
    matrix = rng.normal(size=(3, len(inside)))
    matrix[2] = matrix[1] + 10 ** rng.uniform(-12, -3) * rng.normal(size=len(inside))
    matrix *= 10 ** rng.uniform(-4, 4, size=(3, 1))
    room = 0.1 * np.linalg.norm(matrix, axis=1)
    return Rows(matrix, np.full(3, -np.inf), matrix @ inside + room)
