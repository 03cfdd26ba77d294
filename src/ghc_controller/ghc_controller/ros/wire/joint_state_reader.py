"""Converts received joint states and base to the order of the robot model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ghc_controller.core import native
from ghc_controller.errors import InvalidValue
from ghc_controller.ros.wire.joint_state import JointStateValues
from ghc_controller.types import NANOSECONDS, Array, RobotState


class JointStateReader:
    """Reads positions, velocities and applied torques of the joints of one robot.

    The order of a message is looked up once and kept while its names stay the same; joints that
    the robot model does not have (a gripper, a head) are ignored.
    """

    def __init__(self, joint_names: Sequence[str]) -> None:
        self._joints = tuple(joint_names)
        self._names: tuple[str, ...] | None = None
        self._index = np.zeros(0, dtype=np.int64)

    def read(
        self,
        values: JointStateValues,
        epoch: int,
        wrenches: Mapping[str, Array],
        base: Array | None = None,
    ) -> RobotState:
        """State of the robot at the stamp of `values`.

        An effort of NaN means not measured, as reported by drivers without torque sensors; a NaN
        position or velocity is a fault.

        Args:
            base: (13,) of a floating base: position, quaternion x, y, z, w, then linear and
                angular velocity in base axes.

        Raises:
            InvalidValue: a joint is missing or named twice, a field has the wrong size, or an
                entry is not finite (effort: infinite); names the field and the joint.
        """
        if values.name is not self._names:
            self._look_up(values.name)
        effort = self._effort(values.effort) if len(values.effort) else None
        q, v = self._field("position", values.position), self._field("velocity", values.velocity)
        if base is not None:
            q, v = np.concatenate([base[:7], q]), np.concatenate([base[7:], v])
        return RobotState(values.stamp_ns / NANOSECONDS, q, v, effort, wrenches, epoch)

    def _look_up(self, names: tuple[str, ...]) -> None:
        missing = [joint for joint in self._joints if joint not in names]
        if missing:
            raise InvalidValue(
                f"joint_states.name: {', '.join(missing)} missing; given: "
                f"{', '.join(names) or 'none'}"
            )
        twice = [joint for joint in self._joints if names.count(joint) > 1]
        if twice:
            raise InvalidValue(
                f"joint_states.name: '{twice[0]}' is named twice, each joint once expected"
            )
        self._index = np.array([names.index(joint) for joint in self._joints])
        self._names = names

    def _field(self, field: str, given: Array) -> Array:
        values, finite = self._ordered(field, given)
        if not finite:
            bad = self._joints[int(np.argmin(np.isfinite(values)))]
            raise InvalidValue(
                f"joint_states.{field}: not a finite number at joint '{bad}', a number expected"
            )
        return values

    def _effort(self, given: Array) -> Array | None:
        """Reported torques (a,) [Nm]: NaN where not measured; None if no joint has one."""
        values, finite = self._ordered("effort", given)
        if finite:
            return values
        if np.isinf(values).any():
            bad = self._joints[int(np.argmax(np.isinf(values)))]
            raise InvalidValue(
                f"joint_states.effort: infinite at joint '{bad}', a number expected, or NaN "
                "where it is not measured"
            )
        return None if np.isnan(values).all() else values

    def _ordered(self, field: str, given: Array) -> tuple[Array, bool]:
        """Values in the robot's order, and whether all of them are finite."""
        if given.shape[0] != len(self._names or ()):
            raise InvalidValue(
                f"joint_states.{field}: {given.shape[0]} entries given, "
                f"{len(self._names or ())} expected (one per name)"
            )
        return native.in_order(given, self._index)
