"""Joint commands: from serialized bytes to a checked torque."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import GhcError
from ghc_controller.ros.wire.joint_state import (
    JointStateDecoder,
    JointStateFields,
    JointStateValues,
)
from ghc_controller.types import Array


class CommandRejected(GhcError):
    """An invalid joint command; `field` is the invalid field."""

    def __init__(self, field: str, reason: str) -> None:
        self.field = field
        super().__init__(f"{field}: {reason}")


class Command(NamedTuple):
    """A torque for a state."""

    stamp_ns: int  # [ns] of the state that it answers
    torque: Array  # (n,) [Nm] in the bridge's joint order
    sender: str = ""  # name in frame_id, "" = none


class CommandDecoder:
    """Serialized JointState with efforts -> torque in the bridge's joint order.

    Names and sizes are checked when they change, numbers in every message.
    """

    def __init__(
        self, joint_names: Sequence[str], read: Callable[[bytes], JointStateFields]
    ) -> None:
        """Accept commands for exactly `joint_names`, in any order.

        `read` deserializes a message, or raises ValueError.
        """
        self._decoder = JointStateDecoder(read)
        self._joint_names = tuple(joint_names)
        self._checked: tuple[str, ...] | None = None  # names that `_order` was looked up for
        self._order = np.arange(len(joint_names))

    def decode(self, data: bytes) -> Command:
        """Command of the serialized JointState `data`.

        Raises:
            CommandRejected: a field is unknown, missing, of the wrong size or not finite.
        """
        try:
            values = self._decoder.decode(data)
        except ValueError as error:
            raise CommandRejected("message", str(error)) from error
        if values.name is not self._checked:
            self._look_up(values)
        effort: Array = values.effort[self._order]
        if not np.isfinite(effort).all():
            pairs = zip(self._joint_names, effort, strict=True)
            bad = [f"{name} is {value}" for name, value in pairs if not np.isfinite(value)]
            raise CommandRejected("effort", f"{', '.join(bad)}; finite numbers expected")
        return Command(values.stamp_ns, effort, values.frame_id)

    def _look_up(self, values: JointStateValues) -> None:
        self._check_names(values.name)
        n = len(self._joint_names)
        if len(values.effort) != n:
            raise CommandRejected("effort", f"size {len(values.effort)} given, {n} expected")
        place = {name: k for k, name in enumerate(values.name)}
        self._order = np.array([place[name] for name in self._joint_names], dtype=np.int64)
        self._checked = values.name

    def _check_names(self, names: tuple[str, ...]) -> None:
        expected = ", ".join(self._joint_names)
        unknown = [name for name in names if name not in self._joint_names]
        if unknown:
            raise CommandRejected("name", f"unknown joint '{unknown[0]}'; known: {expected}")
        missing = [name for name in self._joint_names if name not in names]
        if missing:
            raise CommandRejected("name", f"'{missing[0]}' is missing; expected: {expected}")
        if len(names) != len(self._joint_names):
            raise CommandRejected("name", f"a joint is named twice; expected: {expected}")
