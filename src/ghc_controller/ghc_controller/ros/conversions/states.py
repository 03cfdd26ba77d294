"""Robot states and their companion messages, from serialized bytes."""

from __future__ import annotations

import numpy as np
from geometry_msgs.msg import WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState

from ghc_controller.errors import InvalidValue
from ghc_controller.ros.wire.cdr import BYTE_ORDER, numbers_behind_strings
from ghc_controller.types import UNIT_TOLERANCE, Array

_POSE, _TWIST = slice(0, 7), slice(43, 49)  # of the numbers of an Odometry; covariances in between


def read_joint_state(data: bytes) -> JointState:
    """Deserialize a JointState.

    Raises:
        ValueError: the bytes are not a JointState.
    """
    try:
        return deserialize_message(data, JointState)
    except Exception as error:  # the middleware's own type, whatever it is
        raise ValueError(f"not a JointState: {error}") from error


def wrench_from_bytes(data: bytes) -> Array:
    """(6,) force [N] and torque [Nm] of a serialized WrenchStamped, in the axes of the message.

    Raises:
        InvalidValue: an entry is not finite, or the bytes are no such message.
    """
    wrench = _numbers(data, WrenchStamped, 1, 6)
    if not np.isfinite(wrench).all():
        raise InvalidValue(f"wrench {wrench.tolist()} given, finite numbers expected")
    return wrench


def base_from_bytes(data: bytes) -> Array:
    """(13,) position [m], unit quaternion x, y, z, w, linear and angular velocity, base axes, of
    a serialized Odometry.

    Raises:
        InvalidValue: an entry is not finite, the quaternion is not of unit length, or the bytes
            are no such message.
    """
    numbers = _numbers(data, Odometry, 2, _TWIST.stop)
    base = np.concatenate([numbers[_POSE], numbers[_TWIST]])
    if not np.isfinite(base).all():
        raise InvalidValue(f"pose and twist {base.tolist()} given, finite numbers expected")
    length = float(np.linalg.norm(base[3:7]))
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise InvalidValue(f"quaternion of length {length:g} given, a unit quaternion expected")
    base[3:7] /= length
    return base


def _numbers(data: bytes, kind: type, strings: int, count: int) -> Array:
    """Numbers of a serialized message of type `kind`, stored directly after its strings."""
    try:
        if not data.startswith(BYTE_ORDER):
            data = bytes(serialize_message(deserialize_message(data, kind)))
        return np.array(numbers_behind_strings(data, strings, count))
    except Exception as error:  # the middleware's own type, whatever it is
        raise InvalidValue(f"no {kind.__name__}: {error}") from error
