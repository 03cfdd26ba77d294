"""Joint states by name, and the base: from values on the wire to the robot model's own order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ghc_controller.errors import InvalidValue
from ghc_controller.ros.wire.joint_state import JointStateValues
from ghc_controller.types import NANOSECONDS, Array, RobotState


class JointStateReader:
    """Reads positions, velocities and applied torques of the joints of one robot.

    The order of a message is looked up once and kept while its names stay the same; joints that
    the robot model does not have (a gripper, a head) are passed over.
    """

    def __init__(self, joint_names: Sequence[str]) -> None:
        self._joints = tuple(joint_names)
        # Compile now: what comes from the wire cannot be written to, decoded messages can.
        for writeable in (False, True):
            values = np.zeros(1)
            values.flags.writeable = writeable
            in_order(values, np.zeros(1, dtype=np.int64))
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

        Args:
            base: (13,) of a floating base: position, quaternion x, y, z, w, then linear and
                angular velocity in base axes.

        Raises:
            InvalidValue: a joint is missing, a field has another size or an entry that is not
                finite; names the field and the joint.
        """
        if values.name is not self._names:
            self._look_up(values.name)
        effort = self._field("effort", values.effort) if len(values.effort) else None
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
        self._index = np.array([names.index(joint) for joint in self._joints])
        self._names = names

    def _field(self, field: str, given: Array) -> Array:
        if given.shape[0] != len(self._names or ()):
            raise InvalidValue(
                f"joint_states.{field}: {given.shape[0]} entries given, "
                f"{len(self._names or ())} expected (one per name)"
            )
        values, finite = in_order(given, self._index)
        if not finite:
            bad = self._joints[int(np.argmin(np.isfinite(values)))]
            raise InvalidValue(f"joint_states.{field}: not a finite number at joint '{bad}'")
        return values


@njit(cache=True)
def in_order(values: Array, index: NDArray[np.int64]) -> tuple[Array, bool]:  # pragma: no cover
    """The entries at `index` (n,), and whether all of them are finite."""
    ordered, finite = np.empty(index.shape[0]), True
    for k in range(index.shape[0]):
        ordered[k] = values[index[k]]
        finite = finite and np.isfinite(ordered[k])
    return ordered, finite
