"""The CDR layout of the bridge's fast messages, so that its loop writes numbers, not messages.

A JointState of seven named joints costs about 45 us to serialize and deserialize through the
message class, most of it for names that never change. Here everything but stamp and numbers is
laid out once and the numbers are written in place. Plain CDR in native byte order; alignment
counts from behind the four bytes of encapsulation:

    JointState:    stamp | frame_id | name[] | position[] | velocity[] | effort[]
    Odometry:      stamp | frame_id | child_frame_id | position, quaternion xyzw, covariance (36)
                   | linear and angular velocity, covariance (36)
    WrenchStamped: stamp | frame_id | force xyz, torque xyz
    Clock:         stamp
"""

from __future__ import annotations

import struct
import sys
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ENCAPSULATION_SIZE = 4  # [bytes]
STAMP_END = ENCAPSULATION_SIZE + 8  # [bytes] sec (int32) and nanosec (uint32) stand before it
NANOSECONDS = 1_000_000_000  # [ns/s]
_COVARIANCE = 36  # entries of a covariance

_STAMP = struct.Struct("=iI")
_LENGTH = struct.Struct("=I")
_ENCAPSULATION = b"\x00\x01\x00\x00" if sys.byteorder == "little" else b"\x00\x00\x00\x00"


def read_stamp(data: bytes) -> int:
    """Stamp [ns] of a serialized message that begins with one."""
    seconds, nanoseconds = _STAMP.unpack_from(data, ENCAPSULATION_SIZE)
    return int(seconds) * NANOSECONDS + int(nanoseconds)


def write_stamp(buffer: bytearray, stamp_ns: int) -> None:
    """Put `stamp_ns` [ns] into a serialized message that begins with a stamp."""
    _STAMP.pack_into(buffer, ENCAPSULATION_SIZE, *divmod(stamp_ns, NANOSECONDS))


def encode_clock(stamp_ns: int) -> bytes:
    """Serialized rosgraph_msgs/Clock of `stamp_ns` [ns]."""
    return _ENCAPSULATION + _STAMP.pack(*divmod(stamp_ns, NANOSECONDS))


class CdrBody:
    """Bytes of a message behind its encapsulation, with zeros where numbers will stand."""

    def __init__(self) -> None:
        """Begin with the room of a stamp."""
        self._body = bytearray(STAMP_END - ENCAPSULATION_SIZE)
        self._pieces: list[tuple[int, int]] = []  # [bytes] begin and end of what is written

    def append_length(self, length: int) -> None:
        """Add the length of the sequence that follows."""
        self._align(4)
        self._write(_LENGTH.pack(length))

    def append_string(self, text: str) -> None:
        """Add a string with its length and closing zero."""
        encoded = text.encode() + b"\x00"
        self.append_length(len(encoded))
        self._write(encoded)

    def append_numbers(self, count: int) -> int:
        """Add room for `count` float64; where it begins [bytes] in the whole message."""
        if count:
            self._align(8)
        start = len(self._body) + ENCAPSULATION_SIZE
        self._body.extend(bytes(8 * count))
        return start

    def _align(self, size: int) -> None:
        self._body.extend(bytes(-len(self._body) % size))

    def _write(self, data: bytes) -> None:
        start = len(self._body)
        self._body.extend(data)
        if self._pieces and self._pieces[-1][1] == start:
            start = self._pieces.pop()[0]
        self._pieces.append((start, len(self._body)))

    def message(self) -> bytearray:
        """The whole message."""
        return bytearray(_ENCAPSULATION) + self._body

    def fixed_pieces(self) -> tuple[tuple[int, bytes], ...]:
        """(begin, bytes) of all but stamp, numbers and padding: the latter is never cleared."""
        return ((0, _ENCAPSULATION),) + tuple(
            (start + ENCAPSULATION_SIZE, bytes(self._body[start:end]))
            for start, end in self._pieces
        )


class JointStateLayout:
    """A serialized JointState with zero numbers, and where its three sequences begin."""

    def __init__(
        self, frame_id: str, names: Sequence[str], position: int, velocity: int, effort: int
    ) -> None:
        """Lay out a message with the given lengths of position, velocity and effort."""
        body = CdrBody()
        body.append_string(frame_id)
        body.append_length(len(names))
        for name in names:
            body.append_string(name)
        starts = []  # [bytes]
        for count in (position, velocity, effort):
            body.append_length(count)
            starts.append(body.append_numbers(count))
        self.position_start, self.velocity_start, self.effort_start = starts
        self.data = body.message()
        self.fixed_pieces = body.fixed_pieces()  # (begin, bytes) of names, lengths and frame_id

    def describes(self, data: bytes) -> bool:
        """Whether `data` is such a message: all of it but stamp and numbers is the same."""
        if len(data) < len(self.data):
            return False
        return all(data.startswith(piece, start) for start, piece in self.fixed_pieces)


def _view(data: bytearray, count: int, start: int) -> Array:
    return np.frombuffer(data, np.float64, count, start) if count else np.empty(0)


class JointStateEncoder:
    """Serialized JointStates of one set of joints; stamp and numbers are replaced in place."""

    def __init__(self, names: Sequence[str], frame_id: str) -> None:
        """Lay out the message for `names`; position, velocity and effort have one entry each."""
        n = len(names)
        layout = JointStateLayout(frame_id, names, n, n, n)
        self._data = layout.data
        self._position = _view(self._data, n, layout.position_start)
        self._velocity = _view(self._data, n, layout.velocity_start)
        self._effort = _view(self._data, n, layout.effort_start)

    def encode(self, stamp_ns: int, position: Array, velocity: Array, effort: Array) -> bytes:
        """Serialized message; the arrays have shape (n,) [rad], [rad/s], [Nm].

        Raises:
            ValueError: an array has another shape (numpy refuses the assignment).
        """
        write_stamp(self._data, stamp_ns)
        self._position[:] = position
        self._velocity[:] = velocity
        self._effort[:] = effort
        return bytes(self._data)


class WrenchEncoder:
    """Serialized WrenchStamped in one frame."""

    def __init__(self, frame_id: str) -> None:
        """Lay out the message."""
        body = CdrBody()
        body.append_string(frame_id)
        start = body.append_numbers(6)
        self._data = body.message()
        self._wrench = _view(self._data, 6, start)

    def encode(self, stamp_ns: int, wrench: Array) -> bytes:
        """Serialized message of force [N] and torque [Nm], (6,)."""
        write_stamp(self._data, stamp_ns)
        self._wrench[:] = wrench
        return bytes(self._data)


class OdometryEncoder:
    """Serialized Odometry of one floating base; covariances are zero: the truth is known."""

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        """Lay out the message."""
        body = CdrBody()
        body.append_string(frame_id)
        body.append_string(child_frame_id)
        start = body.append_numbers(7 + _COVARIANCE + 6 + _COVARIANCE)
        self._data = body.message()
        numbers = _view(self._data, 7 + _COVARIANCE + 6, start)
        self._pose, self._twist = numbers[:7], numbers[7 + _COVARIANCE :]

    def encode(self, stamp_ns: int, pose: Array, twist: Array) -> bytes:
        """Serialized message of the base's position [m] and quaternion xyzw in the world, (7,),
        and of its linear [m/s] and angular [rad/s] velocity in its own axes, (6,)."""
        write_stamp(self._data, stamp_ns)
        self._pose[:] = pose
        self._twist[:] = twist
        return bytes(self._data)
