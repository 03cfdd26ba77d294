"""Whether a measured base, or a measured wrench, can be true."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.types import UNIT_TOLERANCE, Array

FARTHEST = 1000.0  # [m] from the origin of the world
FASTEST, FASTEST_TURN = 10.0, 20.0  # [m/s], [rad/s] of the base; a fall from 1.5 m is 5.4 m/s
SHIFT, TURN = 0.05, 0.1  # [m], [rad] between where the twist leads to and where the base is
WEIGHTS = 20.0  # [-] of the robot's weight that a contact may carry; an impact has 2 to 10
LEAST_CAP = 2000.0  # [N] of the same, for light robots: as of references of force
LEVER = 1.0  # [m] that makes a cap of moments of one of forces


def check_base(pose: Array, twist: Array) -> None:
    """Raise InvalidValue where a base is further away, or faster, than it can be.

    Args:
        pose: (7,) position [m] and quaternion x, y, z, w.
        twist: (6,) linear [m/s] and angular velocity [rad/s], base axes.
    """
    for field, values, most, unit in (
        ("pose.position", pose[:3], FARTHEST, "m"),
        ("twist.linear", twist[:3], FASTEST, "m/s"),
        ("twist.angular", twist[3:6], FASTEST_TURN, "rad/s"),
    ):
        largest = float(np.abs(values).max())
        if not largest <= most:
            raise InvalidValue(
                f"odom.{field}: {largest:g} {unit} given, at most {most:g} {unit} expected"
            )


def check_orientation(quaternion: Array) -> None:
    """Raise InvalidValue where the quaternion (4,) of a base in q is not of unit length."""
    length = math.hypot(*quaternion)
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise InvalidValue(
            f"q[3:7] of the base: quaternion of length {length:g} given, a unit quaternion "
            "x, y, z, w expected"
        )


def base_jump(
    before: tuple[Array, Array], now: tuple[Array, Array], step: float, passed: float
) -> str:
    """What jumped between two bases, each (7,) pose and (6,) twist; "" = nothing.

    Args:
        step: [s] over which a twist predicts the pose of the base.
        passed: [s] between the two, for the text.
    """
    (pose, twist), (pose_now, twist_now) = before, now
    speed = max(math.hypot(*twist[:3]), math.hypot(*twist_now[:3]))
    moved = math.hypot(*(pose_now[:3] - pose[:3]))
    if moved > SHIFT + 2.0 * speed * step:
        return f"odom.pose.position: moved by {moved:g} m at {speed:g} m/s within {passed:g} s"
    rate = max(math.hypot(*twist[3:6]), math.hypot(*twist_now[3:6]))
    # A quaternion and its negative are one orientation.
    cosine = abs(float(pose[3:7] @ pose_now[3:7]))
    turned = 2.0 * math.acos(min(cosine, 1.0))
    if turned > TURN + 2.0 * rate * step:
        return (
            f"odom.pose.orientation: turned by {turned:g} rad at {rate:g} rad/s within "
            f"{passed:g} s"
        )
    return ""


def check_wrenches(wrenches: Mapping[str, Array], weight: float) -> None:
    """Raise InvalidValue where a wrench (6,) [N], [Nm] is larger than a contact can carry.

    A force may jump, as it does at every impact, so only its size is checked.

    Args:
        wrenches: by the name of the contact.
        weight: [N] of the robot.
    """
    most = max(WEIGHTS * weight, LEAST_CAP)
    for name, wrench in wrenches.items():
        for field, values, cap, unit in (
            ("force", wrench[:3], most, "N"),
            ("torque", wrench[3:], most * LEVER, "Nm"),
        ):
            largest = float(np.abs(values).max())
            if not largest <= cap:
                raise InvalidValue(
                    f"contacts/{name}.{field}: {largest:g} {unit} given, at most {cap:g} {unit} "
                    f"expected ({WEIGHTS:g} times the weight of the robot, or {LEAST_CAP:g} N)"
                )
