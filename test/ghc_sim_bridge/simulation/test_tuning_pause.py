"""Changes of a running controller go on where they were after a time without steps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ghc_controller.controller import Controller
from ghc_controller.hierarchy.transition import Profile
from ghc_controller.settings import Settings
from ghc_controller.types import Array, RobotState

DT = 1e-3  # [s]
Q = np.array([0.3, 0.7, -0.4, 1.1, 0.5, -0.6, 0.2])  # [rad]
BEFORE, AFTER = 300, 800  # steps of a change that takes 1000
SOFT, STIFF = 100.0, 400.0  # [1/s^2]
NAME = "tasks.posture.stiffness"


def _state(time: float) -> RobotState:
    return RobotState(time, Q, np.zeros(7))


def _lost(_: Controller, __: float) -> None:
    """No state comes."""


def _latched(controller: Controller, begin: float) -> None:
    """The controller brakes, as in the mode latched."""
    for step in range(500):
        controller.brake(_state(begin + step * DT))


def _gains(pause: float, meanwhile: Callable[[Controller, float], None] = _lost) -> Array:
    """(T,) [1/s^2] stiffness at each step, with a pause [s] in the time of states."""
    controller = Controller.for_robot("kuka_lwr", Settings.of(control_dt=DT))
    controller.tune({NAME: SOFT})
    controller.start(_state(0.0))
    controller.step(_state(0.0))
    controller.tune({NAME: STIFF, "velocity_damping": 10.0}, duration=1.0)
    found = []
    for step in range(BEFORE + AFTER):
        if step == BEFORE:
            meanwhile(controller, (step + 1) * DT)
        controller.step(_state((step + 1) * DT + (pause if step >= BEFORE else 0.0)))
        found.append(float(controller.stack.tasks[-1].stiffness[0]))
    assert controller.stack.tasks[-1].name == "posture"
    return np.array(found)


@pytest.mark.parametrize("pause", [0.021, 0.5, 100.0, -0.5])
@pytest.mark.parametrize("meanwhile", [_lost, _latched])
def test_a_pause_does_not_count(
    pause: float, meanwhile: Callable[[Controller, float], None]
) -> None:
    gains = _gains(pause, meanwhile)
    np.testing.assert_allclose(gains, _gains(0.0), rtol=1e-9)
    steepest = 1.875 * (STIFF - SOFT) * DT
    assert np.abs(np.diff(gains)).max() <= steepest + 1e-9
    assert gains[-1] == STIFF


def test_a_few_lost_states_count() -> None:
    """The robot is not held by then, so that time goes on for it: the change ends as planned."""
    gains, even = _gains(0.01), _gains(0.0)
    np.testing.assert_allclose(gains[BEFORE : BEFORE + 200], even[BEFORE + 10 : BEFORE + 210])


def test_without_a_pause_nothing_is_different() -> None:
    s = np.minimum(np.arange(BEFORE + AFTER) * DT, 1.0)
    share = [Profile.MINIMUM_JERK.progress(float(one)) for one in s]
    np.testing.assert_allclose(_gains(0.0), SOFT + (STIFF - SOFT) * np.array(share), rtol=1e-9)
