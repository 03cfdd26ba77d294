"""The bridge's fast messages other than joint states, as numbers (see
ghc_controller.ros.wire.cdr).

Odometry:      stamp | frame_id | child_frame_id | position, quaternion xyzw, covariance (36)
               | linear and angular velocity, covariance (36)
WrenchStamped: stamp | frame_id | force xyz, torque xyz
Clock:         stamp
"""

from __future__ import annotations

from ghc_controller.ros.wire.cdr import ENCAPSULATION, STAMP_END, CdrBody, number_view, write_stamp
from ghc_controller.types import Array

_COVARIANCE = 36  # entries of a covariance


def encode_clock(stamp_ns: int) -> bytes:
    """Serialized rosgraph_msgs/Clock of `stamp_ns` [ns]."""
    data = bytearray(STAMP_END)
    data[: len(ENCAPSULATION)] = ENCAPSULATION
    write_stamp(data, stamp_ns)
    return bytes(data)


class WrenchEncoder:
    """Serialized WrenchStamped in one frame."""

    def __init__(self, frame_id: str) -> None:
        """Lay out the message."""
        body = CdrBody()
        body.append_string(frame_id)
        start = body.append_numbers(6)
        self._data = body.message()
        self._wrench = number_view(self._data, 6, start)

    def encode(self, stamp_ns: int, wrench: Array) -> bytes:
        """Serialized message of force [N] and torque [Nm], (6,)."""
        write_stamp(self._data, stamp_ns)
        self._wrench[:] = wrench
        return bytes(self._data)


class OdometryEncoder:
    """Serialized Odometry of one floating base; covariances are zero: the state is exact."""

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        """Lay out the message."""
        body = CdrBody()
        body.append_string(frame_id)
        body.append_string(child_frame_id)
        start = body.append_numbers(7 + _COVARIANCE + 6 + _COVARIANCE)
        self._data = body.message()
        numbers = number_view(self._data, 7 + _COVARIANCE + 6, start)
        self._pose, self._twist = numbers[:7], numbers[7 + _COVARIANCE :]

    def encode(self, stamp_ns: int, pose: Array, twist: Array) -> bytes:
        """Serialized message of the base's position [m] and quaternion xyzw in the world, (7,),
        and of its linear [m/s] and angular [rad/s] velocity in its own axes, (6,)."""
        write_stamp(self._data, stamp_ns)
        self._pose[:] = pose
        self._twist[:] = twist
        return bytes(self._data)
