"""An obstacle without a planned motion stands still, whatever velocity is given with it."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.constraints import ObstacleDistance, Tick
from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.preview import Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.robot.library import load_robot
from ghc_controller.types import Array, RobotState

PLACE = np.array([0.6, 0.1, 0.8])  # [m]


def _motion(state: Array, jerk: Array) -> PlannedMotion:
    normal = np.array([-1.0, 0.0, 0.0])
    return PlannedMotion("wall", "tool", 0.1, normal, state, jerk, PreviewStatus.RAW)


@pytest.mark.parametrize("time", [0.0, 0.05, 10.0])
def test_its_row_is_that_of_one_at_rest(time: float) -> None:
    """Its position does not follow the velocity, so the row must not count it either."""
    model = load_robot("kuka_lwr").model
    q, v = np.array([0.3, 0.4, 0.1, 1.0, -0.4, -0.9, 0.2]), np.full(7, 0.2)
    tick = Tick(model, model.update(q, v), RobotState(time, q, v), None, 1e-3)
    lowers = []
    for speed in (0.0, 3.0):
        state = np.array([PLACE, [-speed, 0.0, 0.0], [-10.0 * speed, 0.0, 0.0]])
        plan = Preview.of_motions(0.0, 0.01, 10, (_motion(state, np.zeros((0, 3))),))
        np.testing.assert_array_equal(plan.motion_at(0, time)[0], PLACE)
        distance = ObstacleDistance(model, 0.1)
        distance.follow(plan)
        rows = distance.rows(tick)
        assert rows is not None
        lowers.append(rows.lower)
    np.testing.assert_array_equal(lowers[0], lowers[1])


def test_one_with_a_jerk_keeps_its_velocity() -> None:
    state = np.array([PLACE, [-3.0, 0.0, 0.0], np.zeros(3)])
    motion = _motion(state, np.zeros((10, 3)))
    np.testing.assert_array_equal(motion.state, state)
    np.testing.assert_allclose(motion.at(0.05, 0.01)[:2], [PLACE + [-0.15, 0, 0], [-3.0, 0, 0]])


def test_a_generator_that_takes_over_sees_the_state_that_was_given() -> None:
    """It plans on from there: reports of the controller have a state and no jerk."""
    state = np.array([PLACE, np.ones(3), np.ones(3)])
    motion = _motion(state, np.zeros((0, 3)))
    np.testing.assert_array_equal(motion.state, state)
    np.testing.assert_array_equal(motion.at(0.0, 0.01), [PLACE, np.zeros(3), np.zeros(3)])
