"""`brake_acceleration` is checked against torque limits and gravity when a robot is read."""

from __future__ import annotations

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.brakes import deceleration


def _arm(**limits: object) -> ghc.Robot:
    urdf = ghc.load_robot("kuka_lwr").urdf
    task = ghc.posture("posture", stiffness=30.0, damping=20.0)
    return ghc.Robot.from_urdf(urdf, [task], "posture", limits=limits)


def test_more_than_the_torque_limit_allows_anywhere_is_an_error_with_numbers() -> None:
    with pytest.raises(
        ConfigurationError,
        match=r"limits.brake_acceleration: 5000 rad/s\^2 given, at most \d+ expected: "
        r"joint 'joint_2' .*torque limit 176 Nm, of which gravity takes [0-9.e-]+ Nm or more",
    ):
        _arm(brake_acceleration=5000.0)


def test_a_motor_that_cannot_carry_the_arm_does_not_brake_it() -> None:
    """Joint 2 carries up to 90 Nm; the check counts the poses in which it carries least."""
    weak = {"joint_1": 0.01}
    with pytest.raises(ConfigurationError, match="joint 'joint_1' decelerates no harder"):
        _arm(torque=weak)
    assert _arm(torque=weak, brake_acceleration=0.01).brake_acceleration == 0.01


def test_what_is_left_is_what_the_model_does_and_its_state_stays() -> None:
    """Held: braking by it takes the torque limit, gravity included, at the worst pose."""
    robot = _arm()
    model, rng = robot.model, np.random.default_rng(1)
    q = rng.uniform(-1.0, 1.0, 7)
    model.update(q, np.zeros(7))
    left = deceleration(model)
    np.testing.assert_array_equal(model.q, q)
    for _ in range(200):
        q = rng.uniform(model.position_lower, model.position_upper)
        mass, gravity = model.update(q, np.zeros(7)).mass_matrix, model.gravity()
        needed = 0.9 * left.least_held * np.diag(mass) + np.abs(gravity)
        assert (needed <= 1.2 * model.torque_limit).all()
    assert (left.least_held <= left.most_free).all()
