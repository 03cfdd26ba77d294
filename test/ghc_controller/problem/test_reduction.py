"""Motion that keeps contacts, and rows of the QP: the core against plain formulas."""

from __future__ import annotations

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.core import native
from ghc_controller.problem.control_problem import AccelerationRows, ContactRows
from ghc_controller.problem.reduction import kept_by_contacts, null_motion, reduce_contacts
from ghc_controller.types import Array


@pytest.mark.parametrize("seed", range(20))
def test_null_motion_meets_the_rows_with_the_least_motion(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 39))
    q = int(rng.integers(1, n))
    rows, target = rng.normal(size=(q, n)), rng.normal(size=q)
    independent, least, basis = native.null_motion(rows, target)
    assert independent
    assert basis.shape == (n, n - q)
    np.testing.assert_allclose(rows @ least, target, atol=1e-9)
    np.testing.assert_allclose(rows @ basis, 0.0, atol=1e-10)
    np.testing.assert_allclose(basis.T @ basis, np.eye(n - q), atol=1e-12)
    np.testing.assert_allclose(least, np.linalg.pinv(rows) @ target, atol=1e-8)


def test_rows_that_depend_on_others_are_told_and_met_as_well_as_can_be() -> None:
    rng = np.random.default_rng(3)
    rows = rng.normal(size=(4, 9))
    rows[3] = rows[0] + rows[1]
    target = rng.normal(size=4)
    assert not native.null_motion(rows, target)[0]
    least, basis = null_motion(rows, target)
    assert basis.shape == (9, 6)
    np.testing.assert_allclose(rows @ basis, 0.0, atol=1e-10)
    np.testing.assert_allclose(least, np.linalg.pinv(rows) @ target, atol=1e-9)


@pytest.mark.parametrize("in_contact", [False, True])
def test_rows_hold_where_the_quantities_are_inside_their_bounds(in_contact: bool) -> None:
    """Row by row: (bound - row s) times its norm is the room that x, f and tau have left."""
    rng = np.random.default_rng(5)
    n, d, c, a, p, g, r, soft = 7, 4 if in_contact else 7, 3, 7, 6, 3, 5, 2
    basis, offset = rng.normal(size=(n, d)), rng.normal(size=n)
    y0, factor = rng.normal(size=d), rng.normal(size=(d, p))
    f0, force_factor = rng.normal(size=c), rng.normal(size=(c, p))
    general, force_matrix = rng.normal(size=(g, n)), rng.normal(size=(r, c))
    general_force = rng.normal(size=(g, c))
    torque = rng.normal(size=(a, d)), rng.normal(size=a), rng.normal(size=(a, c))
    lower = [rng.normal(size=size) for size in (n, g, r, a)]
    upper = [low + 1.0 for low in lower]
    none = np.zeros(0)
    rows, low, high, norm = native.qp_rows(
        basis if in_contact else None,
        offset if in_contact else None,
        (y0, factor, f0, force_factor),
        lower[0],
        upper[0],
        AccelerationRows(general, lower[1], upper[1], (), general_force),
        soft,
        ContactRows(none, none, none, force_matrix, lower[2], upper[2], f0, none, ()),
        *torque,
        lower[3],
        upper[3],
    )
    s = rng.normal(size=p)
    y, f = y0 + factor @ s, f0 + force_factor @ s
    x = offset + basis @ y if in_contact else y
    tau = torque[0] @ y + torque[1] + torque[2] @ f
    of_general = general @ x + general_force @ f
    value = _in_order(soft, x, of_general, force_matrix @ f, tau)
    least, most = _in_order(soft, *lower), _in_order(soft, *upper)
    np.testing.assert_allclose(np.linalg.norm(rows, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose((rows @ s - low) * norm, value - least, atol=1e-9)
    np.testing.assert_allclose((high - rows @ s) * norm, most - value, atol=1e-9)


def _in_order(soft: int, x: Array, general: Array, force: Array, tau: Array) -> Array:
    """Rows as they are stacked: those that are never relaxed come last."""
    return np.concatenate([x, general[:soft], force, tau, general[soft:]])


def test_transitions_are_judged_in_the_accelerations_that_contacts_leave() -> None:
    """The rows are those of the reduced problem; one that a contact holds is zero, not noise."""
    problem = random_problem(np.random.default_rng(7), 24, [3, 3], strict_alpha(2), contacts=4)
    assert problem.contacts is not None
    problem.jacobian[:3] = problem.contacts.jacobian[:3]
    kept = kept_by_contacts(problem.jacobian, problem.contacts.jacobian)
    assert np.array_equal(kept, reduce_contacts(problem).jacobian)
    assert (kept[:3] == 0.0).all()
    assert np.linalg.matrix_rank(kept) == 3
