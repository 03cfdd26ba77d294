"""sensor_msgs/JointState on the wire: read and written as numbers, not as messages.

    stamp | frame_id | name[] | position[] | velocity[] | effort[]

Serializing and deserializing a JointState of seven joints through the message class takes about
45 us, mostly for names that never change.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from ghc_controller.ros.wire.cdr import CdrBody, number_view, read_stamp, write_stamp
from ghc_controller.types import NANOSECONDS, Array


class JointStateFields(Protocol):
    """Fields read from a sensor_msgs/JointState."""

    header: Any
    name: Sequence[str]
    position: Sequence[float]
    velocity: Sequence[float]
    effort: Sequence[float]


class JointStateValues(NamedTuple):
    """A JointState as numbers; the arrays may be read-only views.

    `name` is the same object as in the previous message if only numbers changed.
    """

    stamp_ns: int  # [ns]
    frame_id: str
    name: tuple[str, ...]
    position: Array  # [rad], one per name, or empty
    velocity: Array  # [rad/s]
    effort: Array  # [Nm]


class JointStateLayout:
    """A serialized JointState with zeros, and the offsets of its three sequences."""

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
        self.frame_id, self.names = frame_id, tuple(names)
        self._counts = (position, velocity, effort)
        self._starts = tuple(starts)
        self.data = body.message()
        self._fixed_pieces = body.fixed_pieces()  # (begin, bytes): names, lengths and frame_id

    def describes(self, data: bytes) -> bool:
        """Whether `data` has this layout: everything but stamp and numbers is equal."""
        if len(data) < len(self.data):
            return False
        for start, piece in self._fixed_pieces:  # noqa: SIM110 - a generator costs twice as much
            if not data.startswith(piece, start):
                return False
        return True

    def values(self, data: bytes | bytearray) -> JointStateValues:
        """The numbers of a message with this layout."""
        (p, v, e), (at_p, at_v, at_e) = self._counts, self._starts
        return JointStateValues(
            read_stamp(data),
            self.frame_id,
            self.names,
            number_view(data, p, at_p),
            number_view(data, v, at_v),
            number_view(data, e, at_e),
        )


class JointStateEncoder:
    """Serialized JointStates of one set of joints; stamp and numbers are replaced in place."""

    def __init__(self, names: Sequence[str], frame_id: str, motion: bool = True) -> None:
        """Lay out the message for `names`: efforts, and with `motion` positions and velocities."""
        n = len(names)
        moving = n if motion else 0
        layout = JointStateLayout(frame_id, names, moving, moving, n)
        self.frame_id = frame_id
        self._data = layout.data
        views = layout.values(self._data)  # they write through: `data` is a bytearray
        self._position, self._velocity, self._effort = views.position, views.velocity, views.effort

    def encode(
        self,
        stamp_ns: int,
        effort: Array,
        position: Array | None = None,
        velocity: Array | None = None,
    ) -> bytes:
        """Serialized message; the arrays have shape (n,) [Nm], [rad], [rad/s].

        Raises:
            ValueError: an array has another shape (numpy rejects the assignment).
        """
        write_stamp(self._data, stamp_ns)
        self._effort[:] = effort
        if position is not None:
            self._position[:] = position
        if velocity is not None:
            self._velocity[:] = velocity
        return bytes(self._data)


class JointStateDecoder:
    """Serialized JointState -> values.

    A message is deserialized in full once; for the following ones with the same layout (names,
    sizes, frame_id) only the numbers are read.
    """

    def __init__(self, read: Callable[[bytes], JointStateFields]) -> None:
        """`read` deserializes a message, or raises ValueError."""
        self._read = read
        self._layout: JointStateLayout | None = None

    def decode(self, data: bytes) -> JointStateValues:
        """Values of a serialized message.

        Raises:
            ValueError: the bytes are no JointState.
        """
        layout = self._layout
        if layout is not None and layout.describes(data):
            return layout.values(data)
        message = self._read(data)
        fields = tuple(
            np.array(field, dtype=np.float64)
            for field in (message.position, message.velocity, message.effort)
        )
        # A message in another byte order or encoding does not match the layout: the next one # is
        # then read in full as well.
        sizes = (len(field) for field in fields)
        self._layout = layout = JointStateLayout(message.header.frame_id, message.name, *sizes)
        stamp = message.header.stamp
        stamp_ns = int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)
        return JointStateValues(stamp_ns, layout.frame_id, layout.names, *fields)
