"""Seeded random problems whose conditioning is controlled: `well_scaled`.

Stated conditioning (checked by a test):
- Every J_l and the stack of all independent task rows, in the null space of the contacts, have
  singular values within [0.3, 3]; rows that depend on levels above lie exactly in their span.
- Targets: |b_l| / sqrt(rows) within [0.3, 3.2].
- Motion rows of contacts: singular values within [0.2, 5].
- Mass matrix: condition at most 100.
- Joints: 7, 17, 32 in turn; every second group of three stands on 3 or 4 point contacts
  (6 more coordinates, unactuated) with friction pyramids and normal force bounds.
- Boxes on torque, in half the problems on acceleration too, are 0.2 to 1.2 times what the first
  two levels would use without them; a known point lies strictly inside all rows.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from reference.hard_cascade import hard_cascade
from reference.plain import Array, Contacts, Level, Plain, Rows

JOINTS = (7, 17, 32)
SINGULAR_VALUES = (0.3, 3.0)
CONTACT_SINGULAR_VALUES = (0.2, 5.0)
MASS_CONDITION = 100.0
DAMPING = 1e-2  # [-] w for which the boxes are chosen
_FRICTION = 0.7
_TARGET = (-0.5, 0.5)  # [-] powers of ten of |b_l| per root of its rows
_MARGIN = 0.05  # [-] of the scale: room of the known point to the boxes


def well_scaled(count: int, seed: int = 5) -> Iterator[Plain]:
    """`count` problems; every one has its own stream, so that the first ones stay the same."""
    for index in range(count):
        rng = np.random.default_rng([seed, index])
        joints = JOINTS[index % len(JOINTS)]
        yield _problem(rng, joints, in_contact=(index // len(JOINTS)) % 2 == 1)


def without_boxes(problem: Plain) -> Plain:
    """The same problem without bounds on x and tau and without general rows."""
    n, a = len(problem.bias), len(problem.torque_lower)
    wide, free = np.full(n, np.inf), np.full(a, np.inf)
    return problem._replace(
        lower=-wide, upper=wide, torque_lower=-free, torque_upper=free, rows=None
    )


def random_mass(rng: np.random.Generator, n: int) -> Array:
    """(n, n) symmetric, condition at most MASS_CONDITION."""
    root = rng.normal(size=(n, n))
    return root @ root.T / n + 0.1 * np.eye(n)


def _problem(rng: np.random.Generator, joints: int, in_contact: bool) -> Plain:
    n = joints + (6 if in_contact else 0)
    mass, bias = random_mass(rng, n), rng.normal(size=n)
    inside = 0.1 * rng.normal(size=n)  # a point inside all rows
    contacts, force, null = None, np.zeros(0), np.eye(n)
    if in_contact:
        contacts, force = point_contacts(rng, n, 3 if joints == 7 else 4)
        contacts = contacts._replace(drift=contacts.jacobian @ inside)
        bias[:6] = contacts.force_jacobian.T[:6] @ force - mass[:6] @ inside
        bias[6:] += contacts.force_jacobian.T[6:] @ force  # loads of the size of the torques
        null = np.linalg.svd(contacts.jacobian)[2][len(contacts.drift) :].T
    levels = _levels(rng, null, contacts)
    wide, u = np.full(n, np.inf), n - joints
    free = np.full(joints, np.inf)
    problem = Plain(levels, mass, bias, -wide, wide, -free, free, None, contacts, u)
    return _with_boxes(rng, problem, inside, force)


def _levels(rng: np.random.Generator, null: Array, contacts: Contacts | None) -> tuple[Level, ...]:
    """3 to 6 levels; the last one is a posture (all free directions) in 6 of 10 problems."""
    n, d = null.shape
    k = int(rng.integers(3, 7))
    sizes = [int(rng.integers(1, 4)) for _ in range(k)]
    posture = rng.random() < 0.6
    free = _spread(rng, min(d, sum(sizes)), d)
    used, levels = 0, []
    for index, m in enumerate(sizes):
        own = min(m, len(free) - used)
        depend = min(m - own, used)
        rows = free[used : used + own]
        if depend:
            mixture = np.linalg.qr(rng.normal(size=(used, depend)))[0].T
            rows = np.vstack([rows, mixture @ free[:used]])
        used += own
        jacobian = rows @ null.T
        if posture and index == k - 1:
            jacobian = np.eye(n)
        elif contacts is not None:  # tasks that moving contacts would serve as well
            mix = rng.normal(size=(len(rows), len(contacts.drift))) / np.sqrt(n)
            jacobian = jacobian + 0.5 * mix @ contacts.jacobian
        target = rng.normal(size=len(jacobian))
        target *= np.sqrt(len(target)) / np.linalg.norm(target)
        levels.append(Level(jacobian, target * 10 ** rng.uniform(*_TARGET)))
    return tuple(levels)


def _spread(rng: np.random.Generator, m: int, d: int) -> Array:
    """(m, d) random rows with singular values drawn log-uniformly from SINGULAR_VALUES."""
    left = np.linalg.qr(rng.normal(size=(m, m)))[0]
    right = np.linalg.qr(rng.normal(size=(d, m)))[0]
    low, high = np.log(SINGULAR_VALUES)
    return left @ (np.exp(rng.uniform(low, high, size=m))[:, None] * right.T)


def _with_boxes(rng: np.random.Generator, problem: Plain, inside: Array, force: Array) -> Plain:
    """Boxes around the known point that are too tight for the first two levels, mostly."""
    two = problem._replace(levels=problem.levels[:2])
    free = hard_cascade(two, DAMPING)
    center = problem.torque(inside, force)
    tight = rng.uniform(0.2, 1.0)
    half = tight * np.abs(free.torque - center).max() * rng.uniform(0.5, 1.5, len(center))
    half += _MARGIN
    problem = problem._replace(torque_lower=center - half, torque_upper=center + half)
    if rng.random() < 0.5:
        size = tight * np.abs(free.x - inside).max() * rng.uniform(0.5, 1.5, len(inside))
        size += _MARGIN
        problem = problem._replace(lower=inside - size, upper=inside + size)
    if rng.random() < 0.3:
        matrix = rng.normal(size=(int(rng.integers(1, 4)), len(inside))) / np.sqrt(len(inside))
        upper = matrix @ inside + _MARGIN + tight * np.abs(matrix @ (free.x - inside))
        problem = problem._replace(rows=Rows(matrix, np.full(len(upper), -np.inf), upper))
    return problem


def point_contacts(rng: np.random.Generator, n: int, count: int) -> tuple[Contacts, Array]:
    """Contacts under a body, normals up, and forces (c,) strictly inside their pyramids.

    The drift is left at zero. Lever arms: spread around the body in the plane, so that the normal
    forces can carry any small moment.
    """
    turn = rng.uniform(0, 2 * np.pi)
    while True:
        jacobian = rng.normal(size=(3 * count, n)) / np.sqrt(n)
        for c in range(count):
            angle = turn + 2 * np.pi * (c + rng.uniform(-0.2, 0.2)) / count
            x, y, z = *(rng.uniform(0.5, 1.0) * np.array([np.cos(angle), np.sin(angle)])), -0.5
            jacobian[3 * c : 3 * c + 3, :3] = np.eye(3)
            jacobian[3 * c : 3 * c + 3, 3:6] = -np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        sigma = np.linalg.svd(jacobian, compute_uv=False)
        if sigma[-1] >= CONTACT_SINGULAR_VALUES[0] and sigma[0] <= CONTACT_SINGULAR_VALUES[1]:
            break
    force = np.tile([0.0, 0.0, 40.0], count) + rng.uniform(-5, 5, 3 * count)
    names = 3 * count
    normal = np.zeros((count, names))
    normal[np.arange(count), 2 + 3 * np.arange(count)] = 1.0
    cone = np.array([[1, 0], [-1, 0], [0, 1], [0, -1]], dtype=float)
    pyramid = np.kron(np.eye(count), np.hstack([cone, np.full((4, 1), -_FRICTION)]))
    forces = Rows(
        np.vstack([normal, pyramid]),
        np.append(np.full(count, 2.0), np.full(4 * count, -np.inf)),
        np.append(np.full(count, 100.0), np.zeros(4 * count)),
    )
    factor = np.eye(names) / np.sqrt(1e-3)
    center = force + rng.normal(size=names)
    return Contacts(jacobian, np.zeros(names), jacobian, forces, center, factor, count), force
