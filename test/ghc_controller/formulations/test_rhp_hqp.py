"""rhp_hqp and hqp_transition: exact at orders, and how continuous between them."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.problems.order_problems import (
    answer_on_ramp,
    bounded,
    identical_tasks,
    jump,
    largest_step,
    order,
    well_scaled_problem,
)
from benchmarks.ramps.order_ramps import REMOVAL, SWAP
from ghc_controller.controller import Controller
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import (
    FormulationSettings,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.formulations.rhp_hqp import recursive_projection
from ghc_controller.hierarchy import (
    Candidate,
    Priorities,
    PriorityMatrix,
    Transition,
    matrix_from_hierarchy,
)
from ghc_controller.hierarchy.level_slots import LevelSlots
from ghc_controller.settings import Settings
from ghc_controller.types import Array, RobotState


def _settings(w: float, constant: bool = False) -> FormulationSettings:
    return FormulationSettings(regularization=w, rhp_constant_weights=constant)


@pytest.mark.parametrize(("sizes", "n"), [((3, 2, 7), 7), ((1, 3, 3, 1, 17), 17)])
@pytest.mark.parametrize("bounds", [False, True])
def test_equals_hqp_at_strict_orders(sizes: tuple[int, ...], n: int, bounds: bool) -> None:
    """Same damping: 200 well-scaled problems, posture last, 1e-8 relative, bounds off and on."""
    rng = np.random.default_rng(0)
    k, solved_by_qp = len(sizes), 0
    hqp, rhp = make_formulation("hqp"), make_formulation("rhp_hqp")
    for _ in range(200):
        depth = [*rng.permutation(k - 1), k - 1]
        alpha = order(*[[int(task)] for task in depth], tasks=k)
        problem = well_scaled_problem(rng, sizes, n, Priorities.of(alpha))
        expected = hqp.solve(problem)
        if bounds:
            problem = bounded(problem, expected.acceleration, 0.5)
            expected = hqp.solve(problem)
        solved_by_qp += expected.qp_solved
        found = rhp.solve(problem)
        assert found.status is expected.status is SolutionStatus.SOLVED
        x = expected.acceleration
        assert np.linalg.norm(found.acceleration - x) < 1e-8 * np.linalg.norm(x)
    assert solved_by_qp > 100 if bounds else solved_by_qp == 0


@pytest.mark.parametrize("constant", [False, True])
def test_swap_of_identical_jacobians(constant: bool) -> None:
    """Rows that count with sqrt(phi): no jump at the ends; constant weights: more than 0.3."""
    rng = np.random.default_rng(1)
    settings = _settings(1e-2, constant)
    jumps = [
        jump(answer_on_ramp("rhp_hqp", settings, identical_tasks(rng), SWAP)) for _ in range(60)
    ]
    if constant:
        assert np.median(jumps) > 0.3
    else:
        assert np.median(jumps) < 1e-6


@pytest.mark.parametrize(("w", "least", "most"), [(1e-2, 0.058, 0.078), (1e-4, 0.47, 0.53)])
def test_removal_over_a_posture_follows_the_damping(w: float, least: float, most: float) -> None:
    """The released direction goes with (1-s)^2 / ((1-s)^2 + w / sigma^2): 60 problems."""
    rng = np.random.default_rng(2)
    steps = []
    for _ in range(60):
        problem = well_scaled_problem(rng, (3, 3, 7), 7, Priorities.of(REMOVAL[0]))
        steps.append(largest_step(answer_on_ramp("rhp_hqp", _settings(w), problem, REMOVAL)))
    assert least < np.median(steps) < most


@pytest.mark.parametrize("w", [1e-2, 1e-4])
@pytest.mark.parametrize("name", ["hqp_transition", "cascade"])
def test_blends_are_linear_in_a_removal(name: str, w: float) -> None:
    """The largest of 100 steps is at most 1.1 % of the change: 20 of the problems above."""
    rng = np.random.default_rng(2)
    for _ in range(20):
        problem = well_scaled_problem(rng, (3, 3, 7), 7, Priorities.of(REMOVAL[0]))
        assert largest_step(answer_on_ramp(name, _settings(w), problem, REMOVAL)) < 0.011


def test_level_above_is_kept_on_a_ramp() -> None:
    """While levels 2 and 3 swap, level 1 is met as well as at the ends: 20 problems, bounds on."""
    rng = np.random.default_rng(3)
    start = order([0], [1], [2], [3], tasks=4)
    goal = order([0], [2], [1], [3], tasks=4)
    for _ in range(20):
        problem = well_scaled_problem(rng, (1, 3, 3, 17), 17, Priorities.of(start))
        free = make_formulation("hqp").solve(problem).acceleration
        tight = bounded(problem, free, 0.6)
        x = answer_on_ramp("rhp_hqp", _settings(1e-2), tight, (start, goal))
        missed = [abs(problem.jacobian[0] @ x(s) - problem.target[0]) for s in (0, 0.3, 0.7, 1)]
        assert np.ptp(missed) < 1e-6


def test_projection_of_strict_levels_is_the_null_space() -> None:
    """With shares of 1 the recursion gives the projector onto the null space, rank lost or not."""
    rng = np.random.default_rng(4)
    upper, lower = rng.normal(size=(3, 9)), rng.normal(size=(3, 9))
    lower[0] = upper.sum(axis=0)  # a row that the first level has already
    P = recursive_projection(np.eye(9), upper, np.ones(3), 1e-4)
    P = recursive_projection(P, lower, np.ones(3), 1e-4)
    both = np.vstack([upper, lower])
    assert np.abs(P - (np.eye(9) - np.linalg.pinv(both) @ both)).max() < 1e-12


def test_full_share_is_kept_out_of_what_follows() -> None:
    """J P = 0 for a task with phi = 1, though P mixes directions that are partly taken."""
    rng = np.random.default_rng(5)
    part, whole = rng.normal(size=(2, 7)), rng.normal(size=(2, 7))
    P = recursive_projection(np.eye(7), part, np.full(2, 0.4), 1e-4)
    P = recursive_projection(P, whole, np.ones(2), 1e-4)
    assert np.abs(whole @ P).max() < 1e-12
    assert np.abs(P - P.T).max() > 1e-2


def test_tasks_that_stay_keep_their_slots() -> None:
    """Removal and insertion: only the column of the task that leaves or comes has fractions."""
    all_four = order([0], [1], [2], [3], tasks=4)
    without = order([0], [2], [3], tasks=4)
    for alphas in ((all_four, without), (without, all_four)):
        mixture = [Candidate(alphas[0], 0.75), Candidate(alphas[1], 0.25)]
        phi = LevelSlots().priority_matrix(mixture)
        rest = phi[:, [0, 2, 3]]
        assert np.array_equal(rest, [[1, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]])
        share = mixture[0].share if alphas[0] is all_four else mixture[1].share
        assert np.array_equal(phi[:, 1], [0, share, share, share])


def test_slots_stay_while_targets_come_and_go() -> None:
    """A third target with a small share leaves the order of the other two to each other."""
    rng = np.random.default_rng(6)
    for _ in range(100):
        alphas = []
        for _ in range(3):
            kept = [int(t) for t in rng.permutation(5)[: rng.integers(2, 6)]]
            alphas.append(order(*[[t] for t in kept], tasks=5))
        if any(np.array_equal(alphas[a], alphas[b]) for a, b in ((0, 1), (0, 2), (1, 2))):
            continue
        slots = LevelSlots()
        two = slots.priority_matrix([Candidate(alphas[0], 0.5), Candidate(alphas[1], 0.5)])
        three = slots.priority_matrix(
            [Candidate(alphas[0], 0.5), Candidate(alphas[1], 0.5), Candidate(alphas[2], 0.0)]
        )
        assert np.array_equal(_changes(two), _changes(three))
        back = slots.priority_matrix([Candidate(alphas[1], 0.5), Candidate(alphas[0], 0.5)])
        assert np.array_equal(_changes(two), _changes(back))


def _changes(phi: Array) -> Array:
    """Rows of Phi at which something changes."""
    before = np.vstack([np.zeros(phi.shape[1]), phi[:-1]])
    return phi[(phi != before).any(axis=1)]


@pytest.mark.parametrize("name", ["rhp_hqp", "hqp_transition"])
def test_what_is_no_order_is_rejected(name: str) -> None:
    """With the tasks and the reason in the message; an order is accepted."""
    controller = Controller.for_robot("kuka_lwr", Settings(formulation=name))
    tasks = controller.robot.task_names
    controller.observe(RobotState(0.0, np.full(7, 0.3), np.zeros(7)))
    alpha = np.array(matrix_from_hierarchy(tasks, " > ".join(tasks)).alpha)
    half, cycle, partly = alpha.copy(), alpha.copy(), alpha.copy()
    half[1, 0] = 0.7
    cycle[0, 2], cycle[2, 0] = 1.0, 0.0
    partly[1, 1] = 0.4
    for matrix, reason in (
        (half, r"alpha\[end_effector, elbow\] = 0 and .* = 0.7 are neither strict nor equal"),
        (cycle, "the priorities of end_effector, elbow, posture are not transitive"),
        (partly, r"task 'elbow' is partly removed \(alpha = 0.4\)"),
    ):
        transition = Transition(PriorityMatrix(tasks, matrix), 0.0, 1.0)
        with pytest.raises(InvalidValue, match=f"'{name}' knows orders only: {reason}"):
            controller.add_transition(transition, 0.0)
    assert controller.add_transition(
        Transition(matrix_from_hierarchy(tasks, "elbow > end_effector = posture"), 0.0, 1.0), 0.0
    )


def test_all_tasks_can_be_removed_and_come_back() -> None:
    """Without a task all joints come to rest, and the ramps there and back do not jump."""
    rng = np.random.default_rng(7)
    none, one = np.ones((2, 2)), order([0], [1], tasks=2)
    problem = well_scaled_problem(rng, (3, 7), 7, Priorities.of(none))
    for ends in ((one, none), (none, one)):
        x = answer_on_ramp("rhp_hqp", _settings(1e-2), problem, ends)
        still = x(0.0 if ends[0] is none else 1.0)
        assert np.abs(still).max() == 0.0
        assert jump(x) < 1e-6
