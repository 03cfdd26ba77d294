"""Joint commands: from the bytes on the wire to a checked torque."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ghc_controller.errors import GhcError
from ghc_sim_bridge.state_cdr import STAMP_END, JointStateLayout, read_stamp

Array = NDArray[np.float64]


class JointStateFields(Protocol):
    """What is read of a sensor_msgs/JointState."""

    header: Any
    name: Sequence[str]
    position: Sequence[float]
    velocity: Sequence[float]
    effort: Sequence[float]


class CommandRejected(GhcError):
    """A joint command that cannot be used; `field` is what is wrong with it."""

    def __init__(self, field: str, reason: str) -> None:
        self.field = field
        super().__init__(f"{field}: {reason}")


def stamp_of(data: bytes) -> int:
    """Stamp [ns] of a serialized message with a header.

    Raises:
        CommandRejected: the message is too short to have one.
    """
    if len(data) < STAMP_END:
        raise CommandRejected("message", f"{len(data)} bytes are no JointState")
    return read_stamp(data)


class CommandDecoder:
    """Serialized JointState with efforts -> torque in the bridge's joint order.

    A message is read and checked in full once. Its layout (names, sizes, epoch) is then
    remembered, and of a message with the same layout only the numbers are checked.
    """

    def __init__(
        self, joint_names: Sequence[str], read: Callable[[bytes], JointStateFields]
    ) -> None:
        """Accept commands for exactly `joint_names`, in any order.

        `read` deserializes a message, or raises ValueError.
        """
        self._read = read
        self._joint_names = tuple(joint_names)
        self._layout: JointStateLayout | None = None
        self._order: NDArray[np.intp] | None = None  # None: already in the bridge's order
        self._epoch = ""

    def decode(self, data: bytes, epoch: int) -> Array:
        """Torque (n,) [Nm] of the serialized JointState `data`, answering a state of `epoch`.

        Raises:
            CommandRejected: a field is unknown, missing, of the wrong size or not finite.
        """
        layout = self._layout
        if layout is not None and layout.describes(data):
            effort = np.frombuffer(data, np.float64, len(self._joint_names), layout.effort_start)
        else:
            effort = self._read_in_full(data)
        if self._epoch and self._epoch != str(epoch):
            raise CommandRejected(
                "header.frame_id", f"epoch '{self._epoch}' given, '{epoch}' expected"
            )
        if self._order is not None:
            effort = effort[self._order]
        if not np.isfinite(effort).all():
            pairs = zip(self._joint_names, effort, strict=True)
            bad = [f"{name} is {value}" for name, value in pairs if not np.isfinite(value)]
            raise CommandRejected("effort", ", ".join(bad))
        return effort

    def _read_in_full(self, data: bytes) -> Array:
        try:
            message = self._read(data)
        except ValueError as error:
            raise CommandRejected("message", str(error)) from error
        self._check_names(message)
        n = len(self._joint_names)
        if len(message.effort) != n:
            raise CommandRejected("effort", f"size {len(message.effort)} given, {n} expected")
        place = {name: k for k, name in enumerate(message.name)}
        order = np.array([place[name] for name in self._joint_names], dtype=np.intp)
        self._order = None if (order == np.arange(n)).all() else order
        self._epoch = message.header.frame_id
        # A message in another byte order or encoding does not fit its layout here: the next one
        # is then read in full as well, instead of wrongly.
        self._layout = JointStateLayout(
            message.header.frame_id,
            message.name,
            len(message.position),
            len(message.velocity),
            len(message.effort),
        )
        return np.array(message.effort)

    def _check_names(self, message: JointStateFields) -> None:
        expected = ", ".join(self._joint_names)
        unknown = [name for name in message.name if name not in self._joint_names]
        if unknown:
            raise CommandRejected("name", f"unknown joint '{unknown[0]}'; known: {expected}")
        missing = [name for name in self._joint_names if name not in message.name]
        if missing:
            raise CommandRejected("name", f"'{missing[0]}' is missing; expected: {expected}")
        if len(message.name) != len(self._joint_names):
            raise CommandRejected("name", f"a joint is named twice; expected: {expected}")
