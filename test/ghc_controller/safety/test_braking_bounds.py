"""Braking keeps the torque limits that the problem keeps: those of the robot and tighter ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.report.report import StepStatus
from ghc_controller.settings import Settings
from ghc_controller.types import Array, RobotState

Q = np.array([0.3, 0.7, -0.4, 1.1, 0.5, -0.6, 0.2])  # [rad]
FAST = np.array([1.2, -1.0, 0.9, 1.3, -1.1, 1.0, 0.8])  # [rad/s]
BOUND = 4.0  # [Nm]


def _controller(bound: float, around: str) -> ghc.Controller:
    # Without a rate limit, which would hide what the braking law asks for.
    settings = Settings.of(torque_bound=bound, torque_bound_around=around, torque_rate_limit=0.0)
    return ghc.Controller.for_robot("kuka_lwr", settings)


def _without_answer(problem: ControlProblem) -> Solution:
    return Solution.without_answer(problem, "none for a test")


def _of_nan(problem: ControlProblem) -> Solution:
    n = len(problem.bias)
    return Solution.unbounded(np.zeros(n), np.full(n, np.nan))


def _center(controller: ghc.Controller, around: str) -> Array:
    gravity: Array = controller.model.gravity().copy()
    return gravity if around == "gravity" else np.zeros(7)


@pytest.mark.parametrize("around", ["zero", "gravity"])
@pytest.mark.parametrize("answer", [_without_answer, _of_nan])
def test_a_step_without_an_answer_keeps_torque_bound(
    monkeypatch: pytest.MonkeyPatch, around: str, answer: Any
) -> None:
    """Also where the answer is no number, which the gate replaces."""
    controller, free = _controller(BOUND, around), _controller(0.0, around)
    excess = []
    for one in (controller, free):
        one.start(RobotState(0.0, Q, np.zeros(7)))
        monkeypatch.setattr(one.formulation, "solve", answer)
        monkeypatch.setattr(one._compiled, "takes", lambda _: False)
        result = one.step(RobotState(0.001, Q, FAST))
        assert (result.status is StepStatus.FALLBACK) == (answer is _without_answer)
        excess.append(np.abs(result.torque - _center(one, around)).max() - BOUND)
    assert excess[0] <= 1e-12
    assert excess[1] > 1.0  # without the bound the same braking exceeds it


@pytest.mark.parametrize("around", ["zero", "gravity"])
def test_a_latched_controller_keeps_torque_bound(around: str) -> None:
    controller = _controller(BOUND, around)
    torque = controller.brake(RobotState(0.0, Q, FAST))
    assert np.abs(torque - _center(controller, around)).max() <= BOUND + 1e-12


def test_bounds_on_both_sides_of_gravity_scale_braking_as_a_whole() -> None:
    """All joints brake less, in proportion, so that one bound decouples no other motion."""
    controller = _controller(BOUND, "gravity")
    still = RobotState(0.0, Q, np.zeros(7))
    np.testing.assert_allclose(controller.brake(still), controller.model.gravity(), atol=1e-12)
    slow, fast = (RobotState(0.0, Q, share * FAST) for share in (1e-3, 0.9))
    added = []
    for state in (slow, fast):
        torque = _controller(BOUND, "gravity").brake(state)
        controller.model.update(state.q, state.v)
        added.append(torque - controller.model.dynamics.bias)
    ratio = added[1] / added[0]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-6)


def test_a_motor_that_cannot_carry_the_arm_keeps_its_limit() -> None:
    """torque_bound around a gravity beyond the limits excludes them: the limits count."""
    controller = _controller(1.0, "gravity")
    controller.model.torque_limit[:] = 0.5
    torque = controller.brake(RobotState(0.0, Q, FAST))
    assert np.isfinite(torque).all()
    assert (np.abs(torque) <= 0.5).all()
