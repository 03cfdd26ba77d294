"""Joint states by name, and the base: from messages to the robot model's own order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array, RobotState


class JointStateLike(Protocol):
    """The fields of sensor_msgs/JointState."""

    name: Sequence[str]
    position: Sequence[float]
    velocity: Sequence[float]
    effort: Sequence[float]


class JointStateReader:
    """Reads positions, velocities and applied torques of the joints of one robot.

    The order of a message is looked up once and kept while its names stay the same; joints that
    the robot model does not have (a gripper, a head) are passed over.
    """

    def __init__(self, joint_names: Sequence[str]) -> None:
        self._joints = tuple(joint_names)
        self._names: list[str] = []
        self._index = np.zeros(0, dtype=np.int64)

    def read(
        self,
        message: JointStateLike,
        time: float,
        epoch: int,
        wrenches: Mapping[str, Array],
        base: Array | None = None,
    ) -> RobotState:
        """State of the robot at `time` [s].

        Args:
            base: (13,) of a floating base: position, quaternion x, y, z, w, then linear and
                angular velocity in base axes.

        Raises:
            InvalidValue: a joint is missing, a field has another size or an entry that is not
                finite; names the field and the joint.
        """
        if message.name != self._names:
            self._look_up(message.name)
        effort = self._field(message, "effort") if len(message.effort) else None
        q, v = self._field(message, "position"), self._field(message, "velocity")
        if base is not None:
            q, v = np.concatenate([base[:7], q]), np.concatenate([base[7:], v])
        return RobotState(time, q, v, effort, wrenches, epoch)

    def _look_up(self, names: Sequence[str]) -> None:
        given = list(names)
        missing = [joint for joint in self._joints if joint not in given]
        if missing:
            raise InvalidValue(
                f"joint_states.name: {', '.join(missing)} missing; given: "
                f"{', '.join(given) or 'none'}"
            )
        self._index = np.array([given.index(joint) for joint in self._joints])
        self._names = given

    def _field(self, message: JointStateLike, field: str) -> Array:
        values = np.array(getattr(message, field), dtype=np.float64)
        if values.shape[0] != len(self._names):
            raise InvalidValue(
                f"joint_states.{field}: {values.shape[0]} entries given, "
                f"{len(self._names)} expected (one per name)"
            )
        values = values[self._index]
        if not np.isfinite(values).all():
            bad = self._joints[int(np.argmin(np.isfinite(values)))]
            raise InvalidValue(f"joint_states.{field}: not a finite number at joint '{bad}'")
        return values
