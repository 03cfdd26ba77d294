"""States that can be true go through; others are rejected by field and joint."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller import load_robot
from ghc_controller.errors import InvalidValue
from ghc_controller.safety.plausibility import (
    CONFIRMATIONS,
    POSITION_MARGIN,
    ImplausibleStart,
    StatePlausibility,
)
from ghc_controller.types import Array, RobotState

MODEL = load_robot("kuka_lwr").model
HOME = np.array([0.1, -0.4, 0.1, 1.4, 0.1, -1.0, 0.1])  # [rad]
DT = 5e-3  # [s]
STILL = np.zeros(7)


def _begun() -> StatePlausibility:
    check = StatePlausibility(MODEL.joint_names, MODEL.limits)
    check.check(RobotState(0.0, HOME, STILL))
    return check


def _moved(by: float, joint: int = 2) -> Array:
    q = HOME.copy()
    q[joint] += by
    return q


def test_motions_up_to_three_times_the_velocity_limit_go_through() -> None:
    """Sines of all joints at 200 Hz, every third state missed (seed 5)."""
    rng = np.random.default_rng(5)
    check = StatePlausibility(MODEL.joint_names, MODEL.limits)
    fast = 3.0 * MODEL.limits.velocity
    phase = rng.uniform(0.0, 6.0, 7)
    for k in range(2000):
        t = k * DT
        if k % 3 == 1:
            continue
        w = fast / 0.3
        check.check(
            RobotState(t, HOME + 0.3 * np.sin(w * t + phase), 0.3 * w * np.cos(w * t + phase))
        )
        assert check.jumped == ""


@pytest.mark.parametrize("joint", range(7))
def test_a_start_outside_the_limits_is_refused_by_joint(joint: int) -> None:
    q = HOME.copy()
    q[joint] = MODEL.limits.position_upper[joint] + 0.06
    check = StatePlausibility(MODEL.joint_names, MODEL.limits)
    with pytest.raises(ImplausibleStart, match=f"'joint_{joint + 1}' given.* expected"):
        check.check(RobotState(0.0, q, STILL))
    check.check(RobotState(DT, HOME, STILL))


@pytest.mark.parametrize(
    ("q", "v", "field"),
    [
        (_moved(1.0), STILL, "joint_states.position: 'joint_3' moved by 1 rad"),
        (_moved(10.0), STILL, "joint_states.position: 10.1 rad at 'joint_3'"),
        (_moved(1e300), STILL, "joint_states.position: 1e"),
        (HOME, STILL + 1e3, "joint_states.velocity: 1000 rad/s at"),
        (HOME, STILL - 1e300, "joint_states.velocity: -1e"),
    ],
)
def test_a_state_that_cannot_be_is_refused_and_the_next_one_is_not(
    q: Array, v: Array, field: str
) -> None:
    check = _begun()
    for k in range(1, 20):
        with pytest.raises(InvalidValue, match=field):
            check.check(RobotState(k * DT - 0.001, q, v))
        check.check(RobotState(k * DT, HOME, STILL))


def test_a_jump_that_lasts_is_told_once_and_then_believed() -> None:
    check = _begun()
    for k in range(1, CONFIRMATIONS):
        with pytest.raises(InvalidValue):
            check.check(RobotState(k * DT, _moved(1.0), STILL))
    check.check(RobotState(CONFIRMATIONS * DT, _moved(1.0), STILL))
    assert "'joint_3' moved by 1 rad" in check.jumped
    check.check(RobotState((CONFIRMATIONS + 1) * DT, _moved(1.0), STILL))
    assert check.jumped == ""


def test_after_a_gap_the_robot_may_be_anywhere_inside_its_limits() -> None:
    check = _begun()
    check.resume()
    check.check(RobotState(30.0, _moved(1.0), STILL))
    assert check.jumped == ""
    assert POSITION_MARGIN > 0.0


WEIGHT = 300.0  # [N]
BASE = np.array([0.0, 0.0, 0.6, 0.0, 0.0, 0.0, 1.0])  # [m], quaternion


def _standing(base: Array = BASE, twist: Array | None = None, time: float = 0.0) -> RobotState:
    v = np.concatenate([np.zeros(6) if twist is None else twist, STILL])
    return RobotState(time, np.concatenate([base, HOME]), v)


def _base(position: Array, angle: float = 0.0, sign: float = 1.0) -> Array:
    """Turned about y [rad]; `sign` -1: the same orientation by the other quaternion."""
    turn = sign * np.array([0.0, np.sin(angle / 2), 0.0, np.cos(angle / 2)])
    return np.concatenate([position, turn])


@pytest.mark.parametrize(
    ("base", "twist", "field"),
    [
        (_base([0.2, 0.0, 0.6]), np.zeros(6), "odom.pose.position: moved by 0.2 m"),
        (_base([1e300, 0.0, 0.6]), np.zeros(6), "odom.pose.position: 1e"),
        (_base(BASE[:3], 0.5), np.zeros(6), "odom.pose.orientation: turned by 0.5 rad"),
        (BASE, np.array([11.0, 0, 0, 0, 0, 0]), "odom.twist.linear: 11 m/s"),
        (BASE, np.array([0, 0, 0, 0, -1e300, 0]), "odom.twist.angular: 1e"),
    ],
)
def test_a_base_that_cannot_be_is_refused_and_believed_only_if_it_lasts(
    base: Array, twist: Array, field: str
) -> None:
    check = StatePlausibility(MODEL.joint_names, MODEL.limits, WEIGHT)
    check.check(_standing())
    for k in range(1, 20):
        with pytest.raises(InvalidValue, match=field):
            check.check(_standing(base, twist, k * DT - 0.001))
        check.check(_standing(_base(BASE[:3], sign=(-1.0) ** k), time=k * DT))
        assert check.jumped == ""
    if "moved" in field or "turned" in field:
        for k in range(20, 19 + CONFIRMATIONS):
            with pytest.raises(InvalidValue, match=field):
                check.check(_standing(base, twist, k * DT))
        check.check(_standing(base, twist, 22 * DT))
        assert check.jumped.startswith(field)


def test_a_base_may_move_turn_and_fall(seed: int = 2) -> None:
    """Up to 6 m/s and 10 rad/s along random directions at 200 Hz, two states in three missed."""
    rng = np.random.default_rng(seed)
    check = StatePlausibility(MODEL.joint_names, MODEL.limits, WEIGHT)
    direction = rng.normal(size=3)
    direction *= 6.0 / np.linalg.norm(direction)
    for k in range(0, 400, 3):
        t = k * DT
        base = _base(BASE[:3] + np.sin(t) * direction, 10.0 * np.sin(t))
        twist = np.concatenate([np.cos(t) * direction, [0.0, 10.0 * np.cos(t), 0.0]])
        check.check(_standing(base, twist, t))
        assert check.jumped == ""


def test_a_wrench_is_bounded_by_the_weight_and_may_jump() -> None:
    check = StatePlausibility(MODEL.joint_names, MODEL.limits, WEIGHT)
    push = np.array([0.0, 0.0, 10.0 * WEIGHT, 0.0, 50.0, 0.0])
    for k, wrench in enumerate([np.zeros(6), push, -push, np.zeros(6)]):
        check.check(RobotState(k * DT, HOME, STILL, None, {"tool": wrench}))
    for bad, field in ((0, "force"), (4, "torque")):
        wrench = push.copy()
        wrench[bad] = -21.0 * WEIGHT
        with pytest.raises(InvalidValue, match=f"contacts/tool.{field}: 6300 .* 6000 "):
            check.check(RobotState(5 * DT, HOME, STILL, None, {"tool": wrench}))
