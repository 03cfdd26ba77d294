"""The controller as a library: what it hands out stays as it was."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import fields, replace

import numpy as np
import pytest

from ghc_controller.controller import Controller
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import SolutionStatus
from ghc_controller.robot.library import load_robot
from ghc_controller.types import Array, Bounds, RobotState


def _arrays(value: object) -> list[Array]:
    """All arrays in a problem, its bounds, rows and priorities."""
    if isinstance(value, np.ndarray):
        return [value]
    if isinstance(value, tuple):
        return [array for part in value for array in _arrays(part)]
    if hasattr(value, "__dataclass_fields__"):
        return [array for field in fields(value) for array in _arrays(getattr(value, field.name))]
    return []


def test_a_problem_outlives_the_next_step() -> None:
    """`problem()` gives copies: a step elsewhere changes none of its arrays."""
    controller = Controller.for_robot("kuka_lwr")
    controller.step(RobotState(0.0, np.full(7, 0.4), np.full(7, 0.1)))
    problem = controller.problem()
    before = deepcopy(_arrays(problem))
    assert len(before) > 10
    controller.step(RobotState(1e-3, np.full(7, -0.3), np.full(7, -0.2)))
    after = _arrays(problem)
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(before, after, strict=True))
    moved = _arrays(controller.problem())
    assert not all(np.array_equal(a, b) for a, b in zip(before, moved, strict=True))


def test_a_torque_may_be_changed_in_place() -> None:
    """A driver that adds gravity itself takes it off: the next does not count from there."""
    kept, changed = (Controller.for_robot("kuka_lwr") for _ in range(2))
    q = 0.4 * kept.model.position_upper
    for k in range(5):
        state = RobotState(1e-3 * k, q, np.zeros(7))
        given = changed.step(state).torque
        assert np.array_equal(kept.step(state).torque, given)
        given -= changed.model.gravity()


def test_a_problem_needs_a_step_since_the_last_reset() -> None:
    controller = Controller.for_robot("kuka_lwr")
    for forget in (lambda: None, controller.reset):
        forget()
        with pytest.raises(RuntimeError, match=r"problem\(\) needs a step\(\) before it"):
            controller.problem()
        controller.step(RobotState(0.0, np.full(7, 0.4), np.zeros(7)))


@pytest.mark.parametrize("robot", ["kuka_lwr", "icub"])
def test_after_a_reset_the_same_run_gives_the_same_torques(robot: str) -> None:
    """Noisy states, many active bounds, 60 steps: nothing of the first run is left. Seed 0."""
    controller = Controller.for_robot(robot)
    first = _noisy_run(controller)
    controller.reset()
    assert np.array_equal(_noisy_run(controller), first)


def _noisy_run(controller: Controller) -> Array:
    rng = np.random.default_rng(0)
    start, n, a = _neutral(controller), controller.model.nv, controller.model.na
    torques = []
    for tick in range(60):
        q = start.copy()
        q[-a:] += 0.05 * rng.normal(size=a)
        torques.append(
            controller.step(RobotState(1e-3 * tick, q, 0.3 * rng.normal(size=n))).torque
        )
    return np.array(torques)


def test_matrices_are_judged_alike_before_and_after_steps() -> None:
    """`solvability` knows the contacts of the state that was looked at. Seed 1."""
    rng = np.random.default_rng(1)
    fresh, used = Controller.for_robot("icub"), Controller.for_robot("icub")
    state = RobotState(0.0, _neutral(used), np.zeros(used.model.nv))
    for controller in (fresh, used):
        controller.observe(state)
    k = len(fresh.robot.tasks)
    for _ in range(10):
        alpha = (rng.random((k, k)) < 0.3).astype(float)
        np.fill_diagonal(alpha, 0.0)
        before = fresh.solvability().measure(alpha)
        assert before == used.solvability().measure(alpha)
    fresh.step(state)
    assert fresh.solvability().measure(alpha) == pytest.approx(before, rel=1e-9)


def test_a_problem_can_be_solved_again_and_again_after_a_step() -> None:
    """The pivots of a step end with it."""
    controller = Controller.for_robot("kuka_lwr")
    q, v = np.full(7, 0.4), np.zeros(7)
    controller.step(RobotState(0.0, q, v))
    problem = controller.problem()
    near = Bounds(problem.bias - 0.1, problem.bias + 0.1)
    tight = replace(problem, torque=near, torque_limit=near)
    for _ in range(1000):
        assert controller.formulation.solve(tight).status is not SolutionStatus.FAILED


def _neutral(controller: Controller) -> Array:
    """Configuration of zeros, with the quaternion of a floating base at one."""
    q = np.zeros(controller.model.nq)
    if controller.model.floating_base:
        q[6] = 1.0
    return q


def test_a_base_whose_quaternion_is_not_of_unit_length_is_rejected_by_its_name() -> None:
    """With posture alone a length of 1.01 was taken, and torques were wrong by 0.6 Nm."""
    robot = load_robot("icub")
    posture = next(task for task in robot.tasks if task.name == "posture")
    controller = Controller(replace(robot, tasks=(posture,), hierarchy="posture"))
    q = controller.model.q.copy()
    state = RobotState(0.0, q, np.zeros(controller.model.nv))
    controller.start(state)
    for scale in (-1.0, 1.0005):  # one orientation; rounding of a driver
        q[3:7] = scale * np.array([0.0, 0.0, 0.0, 1.0])
        controller.start(state)
    q[3:7] = [0.0, 0.0, 0.0, 1.01]
    with pytest.raises(InvalidValue, match=r"q\[3:7\] of the base: quaternion of length 1\.01"):
        controller.start(state)
