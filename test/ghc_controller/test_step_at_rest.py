"""A step where nothing but the state changed is the step made in full, to the last bit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.control.compiled_step import CompiledStep
from ghc_controller.previews.preview import TORQUE_LIMITS, Preview, StaleRule
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.report.report import StepResult
from ghc_controller.tasks.compiled import measured_by_core

DT = 1e-3
STEPS = 60


def _of_the_core() -> ghc.Robot:
    """An arm with those of its tasks that the core measures, in strict order."""
    robot = ghc.load_robot("kuka_lwr")
    tasks = tuple(task for task in robot.tasks if measured_by_core(task) is not None)
    return replace(robot, tasks=tasks, hierarchy=" > ".join(task.name for task in tasks))


def _states(robot: ghc.Robot, rng: np.random.Generator) -> list[ghc.RobotState]:
    """A smooth motion; one state comes twice, and once states were missing for 30 ms."""
    model = robot.model
    lower, upper = np.maximum(model.position_lower, -2.0), np.minimum(model.position_upper, 2.0)
    q = lower + rng.uniform(0.3, 0.7, model.na) * (upper - lower)
    v = rng.uniform(-0.3, 0.3, model.na)
    ticks = np.arange(STEPS)
    ticks[20:] -= 1
    ticks[40:] += 30
    return [ghc.RobotState(k * DT, q + v * k * DT, v) for k in ticks]


def _requests(controller: ghc.Controller) -> dict[int, Callable[[], object]]:
    """What is asked for before steps of these numbers."""
    last = controller.robot.task_names[-1]
    reversed_order = " > ".join(reversed(controller.robot.task_names))
    limit = controller.model.torque_limit
    joint = controller.model.joint_names[1]
    preview = Preview(
        TORQUE_LIMITS,
        start=12 * DT,
        step=DT,
        rows=(joint,),
        lower=np.full((1, 3), -0.5 * limit[1]),
        upper=np.full((1, 3), 0.5 * limit[1]),
        active=(True,),
        status=(PreviewStatus.RAW,),
        conflict=(False,),
        interpolate=False,
        stale=StaleRule.RELEASE,
    )
    task = controller.robot.tasks[-1]

    def move() -> None:
        controller.set_reference(last, task.current(controller.model) + 0.1)

    return {
        3: move,
        6: lambda: controller.tune({f"tasks.{last}.stiffness": 30.0}, 2 * DT),
        12: lambda: controller.follow(preview),
        25: lambda: controller.change_hierarchy(reversed_order, duration=4 * DT),
        34: controller.hold,
        37: controller.activate,
        18: lambda: controller.constraints.reset(),
        50: lambda: controller.priorities.cancel(49 * DT),
        55: lambda: controller.tune({"torque_bound": 30.0}),
    }


@pytest.mark.parametrize("rate", [0.0, -1.0])
def test_torques_are_the_same_numbers(rate: float, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = ghc.Settings(control_dt=DT, torque_rate_limit=rate, torque_bound=60.0)
    rested = [0]
    again = CompiledStep.again
    sides = [ghc.Controller(_of_the_core(), settings) for _ in range(2)]
    short = sides[0]._compiled

    def counted(self: CompiledStep, state: ghc.RobotState) -> object:
        if self is not short:
            return None
        found = again(self, state)
        rested[0] += type(found) is StepResult
        return found

    monkeypatch.setattr(CompiledStep, "again", counted)
    requests = [_requests(controller) for controller in sides]
    states = _states(sides[0].robot, np.random.default_rng(5))
    for number, state in enumerate(states):
        results = []
        for controller, wanted in zip(sides, requests, strict=True):
            if number in wanted:
                wanted[number]()
            results.append(controller.step(state))
        one, other = results
        assert np.array_equal(one.torque, other.torque), number
        assert np.array_equal(one.solution.torque, other.solution.torque)
        assert np.array_equal(one.solution.acceleration, other.solution.acceleration)
        assert (one.time, one.status, one.gate_hits) == (other.time, other.status, other.gate_hits)
        assert [event.phase for event in one.events] == [event.phase for event in other.events]
        assert one.solution[4:8] == other.solution[4:8]
        reports = [controller.report() for controller in sides]
        assert reports[0].counts == reports[1].counts
        assert reports[0].active_constraints == reports[1].active_constraints
        solvers = [controller.formulation.solver for controller in sides]
        assert solvers[0].qps == solvers[1].qps
        assert solvers[0].step_pivots == solvers[1].step_pivots
    braking = [controller.brake(states[-1]) for controller in sides]
    assert np.array_equal(*braking)
    assert rested[0] > STEPS // 4


def test_arrays_of_a_result_stay_as_they_are() -> None:
    controller = ghc.Controller(_of_the_core())
    states = _states(controller.robot, np.random.default_rng(6))[:10]
    results = [controller.step(state) for state in states]
    kept = [(r.torque.copy(), r.solution.acceleration.copy()) for r in results]
    for state in states:
        controller.step(ghc.RobotState(state.time + 1.0, state.q + 0.1, state.v))
    for result, (torque, acceleration) in zip(results, kept, strict=True):
        assert np.array_equal(result.torque, torque)
        assert np.array_equal(result.solution.acceleration, acceleration)
    assert isinstance(results[-1], StepResult)
    assert results[-1]._replace(time=0.0).torque is results[-1].torque
