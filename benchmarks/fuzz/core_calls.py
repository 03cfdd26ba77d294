"""Random calls of the compiled core: `make sanitize` runs them under the sanitizers.

Every argument of a sound call may become another one: other sizes, NaN and infinity, no entries,
another number of axes, not contiguous, another type, read-only, nothing at all. A call returns, or
raises ValueError, TypeError or another documented error; what it may not do is read or write
beyond its arrays, which the sanitizers tell.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ghc_controller.core import native
from ghc_controller.types import Array

Call = tuple[Callable[..., Any], list[Any]]
# OverflowError: an integer that no index holds.
DOCUMENTED = (ValueError, TypeError, IndexError, RuntimeError, OverflowError)


def sound_calls(rng: np.random.Generator) -> list[Call]:
    """Calls whose arguments fit together, of random sizes, also 1 and 0."""
    return [*_of_formulations(rng), *_of_qps(rng), *_of_motions(rng), *_of_levels(rng)]


def _of_formulations(rng: np.random.Generator) -> list[Call]:
    k, d = (int(n) for n in rng.integers(1, (5, 12)))
    sizes = rng.integers(0, 6, k)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    jacobian, target = rng.normal(size=(starts[-1], d)), rng.normal(size=starts[-1])
    alpha = rng.integers(0, 2, (k, k)).astype(float) if rng.random() < 0.5 else rng.random((k, k))
    rule = [1e-7, float(rng.choice([0.0, 1e-6]))]
    tasks = [jacobian, starts, alpha]
    matrix = rng.normal(size=(d, d))
    projectors = native.generalized_projectors(*tasks, *rule)
    return [
        (native.generalized_projectors, [*tasks, *rule]),
        (native.ghc_target, [jacobian, target, starts, alpha, 1e-2, *rule]),
        (native.ghc_factor, [*tasks, projectors, 1e-2, rule[1]]),
        (native.balanced_system, [*tasks, 1e-2, *rule]),
        (native.balanced_target, [jacobian, target, starts, alpha, 1e-2, *rule, 1e-4]),
        (native.priority_weights, [alpha, 1e3, 1e6]),
        (native.weighted_system, [jacobian, target, starts, alpha, 1e3, 1e6, 1.0]),
        (native.cholesky, [matrix @ matrix.T]),
        (native.inverse_factor, [matrix @ matrix.T]),
    ]


def _of_qps(rng: np.random.Generator) -> list[Call]:
    n, e, r, c, a, g = (int(m) for m in rng.integers((1, 0, 0, 0, 1, 0), (12, 4, 20, 6, 9, 4)))
    root = rng.normal(size=(n, n))
    lower = rng.normal(size=r) - 1.0
    qp = [root @ root.T + np.eye(n), rng.normal(size=n), rng.normal(size=(e, n)), np.zeros(e)]
    qp += [rng.normal(size=(r, n)), lower, lower + 2.0]
    d, p = n, n
    parts = (rng.normal(size=d), root, rng.normal(size=c), rng.normal(size=(c, p)))
    x = rng.normal(size=n)
    box, tau = [x - 1.0, x + 1.0], [np.full(a, -9.0), np.full(a, 9.0)]
    general = (rng.normal(size=(g, n)), np.zeros(g), np.ones(g), (), rng.normal(size=(g, c)))
    contacts = (None, None, None, np.eye(c), np.zeros(c), np.ones(c))
    torque = [rng.normal(size=(a, d)), rng.normal(size=a), rng.normal(size=(a, c))]
    return [
        (native.solve_dual, [*qp, 50]),
        (native.qp_not_finite, qp),
        (native.kkt_residuals, [*qp, x, np.zeros(e), np.zeros(r), None]),
        (native.qp_rows, [None, None, parts, *box, general, g // 2, contacts, *torque, *tau]),
        (native.qp_rows, [np.eye(n), x, parts, *box, None, 0, None, *torque, *tau]),
        (native.is_inside, [x, *box]),
        (native.largest_excess, [x, *box]),
        (native.rows_inside, [qp[4], x, lower, lower + 2.0]),
        (native.torques_inside, [x, torque[0], torque[1], *box, *tau]),
        (native.contact_answer, [x, parts[2], x, root, *torque]),
        (native.box_violation, [root, x, x, x, None, *box, *box]),
    ]


def _of_motions(rng: np.random.Generator) -> list[Call]:
    n, steps, m = (int(k) for k in rng.integers((1, 1, 0), (9, 40, 6)))
    state, jerk = rng.normal(size=(3, 3)), rng.normal(size=(steps, 3))
    points, place = rng.normal(size=(n, steps + 4)), float(rng.uniform(-5.0, steps + 9.0))
    q = rng.normal(size=4)
    vectors = [rng.normal(size=n) for _ in range(4)]
    force = [rng.random(m) < 0.5, rng.integers(0, 3, m), 1e-3, 0.5, rng.normal(size=m)]
    force += [rng.normal(size=6), (0.1, 1.0, 1.0, 1.0), *(rng.normal(size=m) for _ in range(6))]
    inverses = np.array([np.eye(steps), np.eye(steps)])
    raw = rng.normal(size=steps)
    return [
        (native.evaluate, [rng.normal(size=(6, n)), 0.3]),
        (native.turned_motion, [q, *rng.normal(size=(3, 3))]),
        (native.integrate, [state, jerk, 0.01]),
        (native.state_at, [state, jerk, 0.01, place]),
        (native.bounds_at, [points, points, place, bool(rng.integers(2))]),
        (native.motion_of, [points, place, 0.01]),
        (
            native.move_joints,
            [np.zeros((steps + 1, 3, n)), 1, *vectors, *np.ones((3, n)), False],
        ),
        (
            native.distance_row,
            [rng.normal(size=(6, n)), *state[:1], *rng.normal(size=(2, 6)), state[1], state]
            + [0.1, 0.05, np.empty(n)],
        ),
        (native.follow_force, force),
        (native.in_order, [rng.normal(size=n), rng.integers(0, n, m)]),
        (native.force_limits, [vectors[0], vectors[1], rng.integers(0, n, m)]),
        (native.bounded_motion, [0.01, np.zeros(3), raw, np.ones(steps), raw + 0.01, 1e-5]),
        (native.force_bounds, [inverses, np.ones(2), 0.0, 1.0, raw, raw + 1.0]),
    ]


def _of_levels(rng: np.random.Generator) -> list[Call]:
    """The QPs of a level of `cascade`, in a mixture of two orders, and what is before it."""
    n, m = int(rng.integers(2, 9)), int(rng.integers(2, 7))
    root = rng.normal(size=(n, n))
    rows = rng.permutation(m)
    orders = (native.Cascade(rows, [m // 2, m]), native.Cascade(rows[::-1], [1, m]))
    bound = np.full(n, float(rng.choice([0.1, 5.0])))
    motion = [rng.normal(size=(m, n)), rng.normal(size=m), root @ root.T + np.eye(n)]
    motion += [rng.normal(size=n), rng.normal(size=n)]
    limits = [-bound, bound, -20.0 * bound, 20.0 * bound, -30.0 * bound, 30.0 * bound]
    shares, mixture = (0.3, 0.7), native.Mixture(1e-2, 1e-3, 1.0)
    out, time = np.empty(n), [native.Clock(1e-3), float(rng.choice([0.0, 3e-3, 1.0]))]
    count = [True, 200, 2000]
    return [
        (mixture.solve, [orders, shares, *motion, *limits, None, None, 0, *count, *time]),
        (mixture.answer, [int(rng.integers(0, 3)), True, 200, 200, *time]),
        (native.Mixture.forces, [mixture]),
        (mixture.reduced, [int(rng.integers(0, 3))]),
        (native.Anchor(0.02).note, [motion[3], 0.1]),
        (native.reduced, [*motion[:4], None, 0, False]),
        (native.null_motion, [motion[0][: n - 1], motion[1][: n - 1]]),
        (native.NullSpace(n, m).append, [motion[0], 1e-3]),
        (native.level_optimum, [*motion[:2], np.zeros(n), native.NullSpace(n, m), 1e-2]),
        (native.Gate(bound, bound).clip, [motion[3], motion[4], out]),
    ]


def changed(rng: np.random.Generator, value: Any) -> Any:
    """Another argument in place of `value`."""
    if isinstance(value, tuple) and value:
        at = int(rng.integers(len(value)))
        kept = value[:at] if rng.random() < 0.1 else (*value[:at], changed(rng, value[at]))
        return (*kept, *value[at + 1 :])
    if isinstance(value, np.ndarray):
        return _changed_array(rng, value)
    if isinstance(value, bool | int | float):
        return rng.choice([0, -1, 1, 3, 2**40, 1e300, float("nan"), float("-inf")])
    return rng.normal(size=3)


def _changed_array(rng: np.random.Generator, value: Array) -> Any:
    value = np.atleast_1d(value)  # it may have been changed before
    shape = list(value.shape)
    shape[int(rng.integers(len(shape)))] += int(rng.choice([-1, 1, 7]))
    edits: Sequence[Callable[[], Any]] = (
        lambda: np.resize(value, [max(size, 0) for size in shape]),
        lambda: np.resize(value, [0] * value.ndim),
        lambda: value[..., None],
        lambda: value.ravel()[:1].reshape(()) if value.size else None,
        lambda: np.repeat(value, 2, axis=0)[::2],
        lambda: np.asfortranarray(value),
        lambda: value[::-1],
        lambda: value.astype(rng.choice(["float32", "int64", "int8", "complex128", "bool"])),
        lambda: value.astype(object),
        lambda: value.tolist(),
        lambda: _read_only(value),
        lambda: _with(rng, value),
        lambda: None,
        lambda: "words",
    )
    return edits[int(rng.integers(len(edits)))]()


def _read_only(value: Array) -> Array:
    copy = value.copy()
    copy.setflags(write=False)
    return copy


def _with(rng: np.random.Generator, value: Array) -> Array:
    """The same with a few odd entries; out of range where they are indices."""
    odd = [np.nan, np.inf, -np.inf, 1e300, 1e-300, 0.0]
    if value.dtype.kind in "iu":
        odd = [-1, 2**31, -(2**62), 10**6]
    copy = value.copy()
    if copy.size:
        where = rng.integers(0, copy.size, 2)
        copy.flat[where] = rng.choice(odd, 2).astype(copy.dtype)
    return copy


def fuzz(rounds: int, seed: int) -> Counter[str]:
    """So many rounds of all calls, each as it is and then with one or two arguments changed."""
    rng = np.random.default_rng(seed)
    ends: Counter[str] = Counter()
    for _ in range(rounds):
        for call, arguments in sound_calls(rng):
            for changes in (0, 1, 2):
                given = list(arguments)
                for at in rng.integers(0, len(given), changes):
                    given[at] = changed(rng, given[at])
                try:
                    call(*given)
                    ends["answered"] += 1
                except DOCUMENTED as error:
                    ends[type(error).__name__] += 1
    return ends


def main() -> int:
    """Print how the calls ended."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    ends = fuzz(options.rounds, options.seed)
    print(f"core: {ends.total()} calls, " + ", ".join(f"{n} {end}" for end, n in ends.items()))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
