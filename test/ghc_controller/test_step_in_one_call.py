"""A step in one call of the core answers as the same step made part by part in Python."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.hierarchy import Candidate, Priorities
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.tasks.compiled import measured_by_core
from ghc_controller.tasks.law import tracking
from ghc_controller.types import Array

DT = 1e-3
STEPS = 40


def _of_the_core(name: str) -> ghc.Robot:
    """A robot with those of its tasks that the core measures, in strict order."""
    robot = ghc.load_robot(name)
    tasks = tuple(task for task in robot.tasks if measured_by_core(task) is not None)[-3:]
    return replace(robot, tasks=tasks, hierarchy=" > ".join(task.name for task in tasks))


def _states(robot: ghc.Robot, seed: int) -> list[ghc.RobotState]:
    """A smooth motion within the limits of the joints; for 25 ms states were missing: a hold."""
    model, rng = robot.model, np.random.default_rng(seed)
    lower = np.maximum(model.position_lower, -2.0)
    upper = np.minimum(model.position_upper, 2.0)
    q = lower + rng.uniform(0.3, 0.7, model.na) * (upper - lower)
    v = rng.uniform(-0.3, 0.3, model.na)
    ticks = np.arange(STEPS)
    ticks[STEPS // 2 :] += 25
    return [ghc.RobotState(k * DT, q + v * k * DT, v) for k in ticks]


def _requests(controller: ghc.Controller, state: ghc.RobotState, rng: np.random.Generator) -> None:
    """A task that moves, another that jumps, and a ramp to the reversed order."""
    moving, jumping = controller.robot.tasks[0], controller.robot.tasks[-1]
    here = moving.current(controller.model)
    points = np.stack([here, here, here])
    points[1:, :3] += 0.05 * rng.standard_normal((2, min(3, points.shape[1])))
    if moving.space is not ReferenceSpace.VECTOR:
        points = np.stack([here, here, here])
    times = np.array([0.0, 0.01, 0.02])
    controller.add_reference(
        ghc.ReferenceTrajectory.for_task(moving, times, points, start_time=state.time + 0.003)
    )
    goal = jumping.current(controller.model) + 0.2
    controller.set_reference(jumping.name, goal, start=state.time + 0.01)
    names = reversed(controller.robot.task_names)
    controller.change_hierarchy(" > ".join(names), start=state.time + 0.015, duration=0.015)


def _never(*_: Any) -> Any:
    raise AssertionError("the step was not made in one call")


def _in_parts(rows: Any, velocity: Array, time: float) -> None:
    """A law of one's own, which Python calls: the same as the core's."""
    tracking(rows, velocity, time)


@pytest.mark.parametrize("robot", ["kuka_lwr", "icub_upper_body"])
@pytest.mark.parametrize("rate", [0.0, -1.0])
@pytest.mark.parametrize("bounded", [False, True])
def test_one_call_equals_the_parts(
    robot: str, rate: float, bounded: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    controllers = []
    for _ in range(2):
        loaded = _of_the_core(robot)
        carry = float(np.abs(loaded.model.gravity()).max())
        settings = ghc.Settings(
            control_dt=DT, torque_rate_limit=rate, torque_bound=1.3 * carry if bounded else 0.0
        )
        controllers.append(ghc.Controller(loaded, settings))
    whole, parts = controllers
    parts.stack.law = _in_parts
    states = _states(whole.robot, 1)
    for controller in controllers:
        controller.observe(states[0])
        _requests(controller, states[0], np.random.default_rng(2))
    monkeypatch.setattr(whole.formulation, "solve", _never)
    for state in states:
        one, other = whole.step(state), parts.step(state)
        np.testing.assert_allclose(one.torque, other.torque, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(
            one.solution.acceleration, other.solution.acceleration, rtol=1e-12, atol=1e-12
        )
        assert one.status is other.status
        assert one.gate_hits == other.gate_hits
        assert [event.phase for event in one.events] == [event.phase for event in other.events]
        assert one.solution.iterations == other.solution.iterations
        reports = whole.report(), parts.report()
        assert reports[0].active_constraints == reports[1].active_constraints
        assert reports[0].counts == reports[1].counts
        assert np.array_equal(reports[0].alpha, reports[1].alpha)
        problems = whole.problem(), parts.problem()
        assert np.array_equal(problems[0].target, problems[1].target)
        assert np.array_equal(problems[0].torque.upper, problems[1].torque.upper)
    assert whole.priorities.is_settled


def test_priorities_that_are_held_reach_the_core(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, parts = (ghc.Controller(_of_the_core("kuka_lwr")) for _ in range(2))
    parts.stack.law = _in_parts
    names = whole.robot.task_names
    orders = [ghc.matrix_from_hierarchy(names, " > ".join(o)).alpha for o in (names, names[::-1])]
    states = _states(whole.robot, 3)
    for controller in (whole, parts):
        controller.start(states[0])
        goal = controller.robot.tasks[-1].current(controller.model) + 0.2
        controller.set_reference(names[-1], goal)
    monkeypatch.setattr(whole.formulation, "solve", _never)
    for state, share in zip(states, np.linspace(0.1, 0.9, STEPS), strict=True):
        mixture = (Candidate(orders[0], 1.0 - share), Candidate(orders[1], share))
        for controller in (whole, parts):
            controller.priorities.hold(Priorities.mixed(mixture), state.time)
        one, other = whole.step(state).torque, parts.step(state).torque
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-12)


def test_a_ramp_with_a_torque_rate_moves_from_its_first_step_on() -> None:
    """Its first step is made in parts as well: the progress follows from the solutions."""
    whole, parts = (ghc.Controller(_of_the_core("kuka_lwr")) for _ in range(2))
    parts.stack.law = _in_parts
    states = _states(whole.robot, 3)
    for controller in (whole, parts):
        names = controller.robot.task_names
        controller.start(states[0])
        controller.set_reference(names[-1], controller.robot.tasks[-1].current(whole.model) + 0.2)
        controller.change_hierarchy(" > ".join(reversed(names)), 0.01, 0.0, torque_rate=100.0)
    for state in states:
        one, other = whole.step(state).torque, parts.step(state).torque
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-12)
    assert whole.priorities.is_paced_at(0.0)


@pytest.mark.parametrize("name", ["regularization", "velocity_damping"])
def test_weights_that_change_while_running_reach_the_core(name: str) -> None:
    tuned = ghc.Controller.for_robot("kuka_lwr")
    value = 3.0 * getattr(tuned.settings.optimization, name)
    fresh = ghc.Controller(
        ghc.load_robot("kuka_lwr"),
        ghc.Settings(optimization=ghc.FormulationSettings(**{name: value})),
    )
    state = _states(tuned.robot, 3)[0]
    before = tuned.step(state).solution.acceleration
    tuned.reset()
    tuned.tune({name: value})
    changed = tuned.step(state).solution.acceleration
    assert np.abs(changed - before).max() > 1e-3
    np.testing.assert_allclose(changed, fresh.step(state).solution.acceleration, rtol=1e-9)
