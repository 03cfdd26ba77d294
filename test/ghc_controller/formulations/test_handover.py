"""From one formulation to another, where one of both has no answer for a while."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.control.handover import FADE, Handover
from ghc_controller.formulations import Formulation
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.report.report import StepStatus
from ghc_controller.types import Array, RobotState

DT = 1e-3  # [s]
Q = np.array([0.3, 0.7, -0.4, 1.1, 0.5, -0.6, 0.2])  # [rad]
STEPS = 1200  # more than the change takes
CHANGE = 20.0  # [Nm] between both formulations


class _Answers:
    """Torques of a formulation at a robot at rest, `apart` from gravity, None at some steps."""

    def __init__(self, apart: Array, fails: Callable[[int], bool]) -> None:
        self._apart, self._fails, self.step = apart, fails, 0

    def __call__(self, problem: ControlProblem) -> Solution:
        self.step += 1
        if self._fails(self.step):
            return Solution.without_answer(problem, "none for a test")
        torque = problem.bias + self._apart
        return Solution.unbounded(np.linalg.solve(problem.mass_matrix, self._apart), torque)


def _torques(
    monkeypatch: pytest.MonkeyPatch,
    old_fails: Callable[[int], bool],
    new_fails: Callable[[int], bool],
) -> tuple[Array, list[StepStatus], ghc.Controller]:
    """(T, 7) torques of a change of formulation at rest, and how each step ended."""
    controller = ghc.Controller.for_robot("kuka_lwr", ghc.Settings.of(torque_rate_limit=0.0))
    controller.start(RobotState(0.0, Q, np.zeros(7)))
    monkeypatch.setattr(controller._compiled, "takes", lambda _: False)
    apart = np.array([0.0, CHANGE, 0.0, -CHANGE, 0.0, 0.0, 0.0])
    old: Formulation = controller.formulation
    monkeypatch.setattr(old, "solve", _Answers(np.zeros(7), lambda _: False))
    torques, statuses = [], []
    for step in range(STEPS):
        if step == 1:
            controller.tune({"formulation": "balanced"}, duration=1.0)
            handover = controller.formulation
            assert isinstance(handover, Handover)
            monkeypatch.setattr(handover.old, "solve", _Answers(np.zeros(7), old_fails))
            monkeypatch.setattr(handover.new, "solve", _Answers(apart, new_fails))
        result = controller.step(RobotState(step * DT, Q, np.zeros(7)))
        torques.append(result.torque)
        statuses.append(result.status)
    return np.array(torques), statuses, controller


def _never(_: int) -> bool:
    return False


def _at_some(step: int) -> bool:
    """Single steps, some in a row, and a tenth of a second."""
    return step in (300, 302, 500, 501, 502, 997) or 700 <= step < 800


@pytest.mark.parametrize("sides", ["old", "new"])
def test_steps_without_the_answer_of_one_side_are_no_jump(
    monkeypatch: pytest.MonkeyPatch, sides: str
) -> None:
    """The torque changes by no more than the fade adds to the blend itself."""
    fails = (_at_some, _never) if sides == "old" else (_never, _at_some)
    torques, statuses, controller = _torques(monkeypatch, *fails)
    blend = 1.875 * CHANGE * DT  # the steepest part of the quintic over 1 s
    largest = np.abs(np.diff(torques, axis=0)).max()
    assert largest <= blend + CHANGE * DT / FADE + 1e-9
    assert set(statuses) == {StepStatus.SOLVED}
    assert controller.formulation.name == "balanced"
    assert not isinstance(controller.formulation, Handover)
    np.testing.assert_allclose(torques[-1] - torques[0], [0, CHANGE, 0, -CHANGE, 0, 0, 0])


def test_with_both_answers_the_shares_are_those_of_the_quintic(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    torques, _, controller = _torques(monkeypatch, _never, _never)
    s = np.clip(np.arange(-1, STEPS - 1) * DT, 0.0, 1.0)
    share = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    np.testing.assert_allclose(torques[:, 1] - torques[0, 1], CHANGE * share, atol=1e-9)
    assert not controller.tuning.moves


def test_a_formulation_that_never_answers_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """Until it is the only one: then the robot brakes, as with any that has no answer."""
    torques, statuses, _ = _torques(monkeypatch, _never, lambda _: True)
    np.testing.assert_array_equal(torques[:1000], np.tile(torques[0], (1000, 1)))
    assert set(statuses[:1000]) == {StepStatus.SOLVED}
    assert statuses[-1] is StepStatus.FALLBACK


def test_a_reset_ends_a_change_that_waits_for_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    _, _, controller = _torques(monkeypatch, _never, lambda step: step >= 990)
    controller.reset()
    assert not isinstance(controller.formulation, Handover)
