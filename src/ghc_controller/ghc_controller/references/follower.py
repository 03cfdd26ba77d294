"""Anything that can be given a reference: name, size, current value."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from enum import Enum

import numpy as np

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import UNIT_TOLERANCE, Array, TaskTarget


class ReferenceSpace(Enum):
    """Meaning of TaskTarget.position; determines how references are interpolated."""

    VECTOR = "vector"  # m numbers
    ORIENTATION = "orientation"  # unit quaternion x, y, z, w
    POSE = "pose"  # x, y, z, then a unit quaternion x, y, z, w


class Follower(ABC):
    """Accepts targets of a fixed size: m numbers, or an orientation or pose with m rows.

    Attributes:
        name: unique name, as in references.
        labels: names of the m numbers ("x", "y", a joint, ...).
        space: ReferenceSpace of target positions.
    """

    space: ReferenceSpace = ReferenceSpace.VECTOR

    def __init__(self, name: str, labels: Sequence[str], reference: Array | None = None) -> None:
        """Store names and an optional standing reference.

        Raises:
            InvalidValue, WrongSize: the reference is invalid, see `check_target`.
        """
        self.name = name
        self.labels = tuple(labels)
        self._reference: TaskTarget | None = None
        if reference is not None:
            self._reference = self.static_target(reference)

    @property
    def size(self) -> int:
        """Number of rows m."""
        return len(self.labels)

    @property
    def reference_size(self) -> int:
        """Entries of TaskTarget.velocity: m, unless the task overrides it."""
        return self.size

    @property
    def position_size(self) -> int:
        """Entries of TaskTarget.position: as above, 4 for an orientation, 7 for a pose."""
        sizes = {ReferenceSpace.ORIENTATION: 4, ReferenceSpace.POSE: 7}
        return sizes.get(self.space, self.reference_size)

    @abstractmethod
    def current(self, model: RobotModel) -> Array:
        """Current task variable, as TaskTarget.position, (position_size,); a new array."""

    def default_target(self, model: RobotModel) -> TaskTarget:
        """Target until a reference arrives: the configured one, else the current value."""
        return self._reference or self.static_target(self.current(model))

    def rest_target(self, model: RobotModel) -> TaskTarget:
        """Target at which the robot stays where it is: the current value, unless that moves it."""
        return self.static_target(self.current(model))

    def static_target(self, position: Array) -> TaskTarget:
        """Target at rest at `position`; checked, see `check_target`, quaternions normalized."""
        values = np.array(position, dtype=np.float64)
        target = TaskTarget(values, *np.zeros((2, self.reference_size)))
        self.check_target(target)
        if self.space is not ReferenceSpace.VECTOR:
            values[-4:] /= np.linalg.norm(values[-4:])
        return target

    def check_target(self, target: TaskTarget) -> None:
        """Reject wrong sizes, entries that are not finite and quaternions not of unit length.

        Raises:
            WrongSize, InvalidValue: name the task, the field, what was given and expected.
        """
        fields = {
            "position": (target.position, self.position_size),
            "velocity": (target.velocity, self.reference_size),
            "acceleration": (target.acceleration, self.reference_size),
            "wrench": (target.wrench, self.reference_size),
        }
        for field, (value, size) in fields.items():
            if value is None:
                continue
            if np.shape(value) != (size,):
                raise WrongSize(f"task '{self.name}', {field}", np.shape(value), (size,))
            if not np.isfinite(value).all():
                raise InvalidValue(
                    f"task '{self.name}', {field}: {value.tolist()} given, finite numbers expected"
                )
        if self.space is not ReferenceSpace.VECTOR:
            length = float(np.linalg.norm(target.position[-4:]))
            if abs(length - 1.0) > UNIT_TOLERANCE:
                raise InvalidValue(
                    f"task '{self.name}', position: quaternion of length {length:g} given,"
                    " a unit quaternion x, y, z, w expected"
                )
