"""Where time is real, a step ends with the last level that was begun in time, or with brakes.

Time is counted here: a clock that moves by a step at each look is the same on every machine.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.core import Clock
from ghc_controller.qp import SolverSettings

DT = 1e-3
SHARE = 0.5


def _controller(looks: float, formulation: str = "cascade", rate: float = 0.0) -> ghc.Controller:
    """One that may look at its clock so often in a step before its time is over."""
    settings = ghc.Settings(
        control_dt=DT,
        formulation=formulation,
        torque_rate_limit=rate,
        solving=SolverSettings(step_time_share=SHARE),
    )
    clock = Clock(SHARE * DT / looks)
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), settings, clock)
    names = controller.robot.task_names
    controller.change_hierarchy(" > ".join(names), duration=0.0)
    return controller


def _states(controller: ghc.Controller) -> list[ghc.RobotState]:
    model, rng = controller.model, np.random.default_rng(7)
    q = rng.uniform(-0.8, 0.8, model.na)
    v = rng.uniform(-0.3, 0.3, model.na)
    return [ghc.RobotState(k * DT, q + v * k * DT, v) for k in range(6)]


def test_levels_that_were_begun_in_time_are_answered() -> None:
    levels = len(_controller(1.0).robot.task_names)
    whole = _controller(1e6)
    for begun in range(1, levels):
        controller = _controller(begun - 0.5)
        for state in _states(controller):
            result, expected = controller.step(state), whole.step(state)
            assert result.status is ghc.StepStatus.SOLVED
            assert result.solution.levels_dropped == levels - begun
            problem = controller.problem()
            rows = slice(0, int(problem.starts[1]))
            first, other = (
                problem.jacobian[rows] @ one.solution.acceleration for one in (result, expected)
            )
            np.testing.assert_allclose(first, other, atol=1e-6)
            assert (result.solution.torque <= problem.torque.upper + 1e-6).all()
        assert controller.counts["late"] == len(_states(controller))
        assert controller.counts["dropped_levels"] == (levels - begun) * len(_states(controller))
        whole.reset()
        whole.change_hierarchy(" > ".join(whole.robot.task_names), duration=0.0)
    assert whole.counts["late"] == 0


def test_the_first_level_is_always_begun() -> None:
    controller = _controller(0.5)
    result = controller.step(_states(controller)[0])
    assert result.status is ghc.StepStatus.SOLVED
    assert result.solution.levels_dropped == len(controller.robot.task_names) - 1
    assert controller.report().counts["late"] == 1


@pytest.mark.parametrize("formulation", ["cascade", "hqp", "balanced"])
def test_without_time_to_relax_bounds_the_joints_brake(formulation: str) -> None:
    results = []
    for looks in (0.5, 1e6):
        controller = _controller(looks, formulation)
        state = _states(controller)[0]
        results.append(controller.step(replace(state, v=30.0 * state.v)))  # faster than allowed
        assert controller.report().counts["late"] == (looks < 1.0)
        assert (np.abs(results[-1].torque) <= controller.model.torque_limit).all()
    assert results[0].status is ghc.StepStatus.FALLBACK
    assert "time" in results[0].solution.reason
    assert results[1].status is ghc.StepStatus.RELAXED


@pytest.mark.parametrize("rate", [0.0, -1.0])
def test_orders_of_a_ramp_share_the_time(rate: float) -> None:
    """However little there is, every order answers its first level; with enough of it all do."""
    late = []
    for looks in np.linspace(0.6, 30.0, 9):
        controller = _controller(float(looks), rate=rate)
        states = _states(controller)
        controller.start(states[0])
        reversed_order = " > ".join(reversed(controller.robot.task_names))
        controller.change_hierarchy(reversed_order, start=0.0, duration=1.0)
        controller.step(states[0])
        result = controller.step(states[1])
        assert result.status is ghc.StepStatus.SOLVED
        assert result.solution.levels_dropped <= len(controller.robot.task_names) - 1
        late.append(controller.counts["late"])
    assert late[0] == 2
    assert late[-1] == 0


def test_without_a_clock_the_share_means_nothing() -> None:
    torques = []
    for share in (1e-9, 1.0):
        settings = ghc.Settings(solving=SolverSettings(step_time_share=share))
        controller = ghc.Controller(ghc.load_robot("kuka_lwr"), settings)
        torques.append([controller.step(state).torque for state in _states(controller)])
        assert controller.counts["late"] == 0
    assert np.array_equal(*torques)


def test_a_clock_that_is_real_does_not_go_back() -> None:
    clock = Clock()
    looks = [clock.now() for _ in range(100)]
    assert looks == sorted(looks)
