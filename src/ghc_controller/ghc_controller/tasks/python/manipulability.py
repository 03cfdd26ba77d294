"""Manipulability of a frame: how far its joints are from a singularity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import Distinct
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.force_control import WORLD_AXES
from ghc_controller.tasks.frame import POSE_ROWS
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task, TaskFields
from ghc_controller.types import Array, TaskRows, TaskTarget

_SINGULAR = 1e-12  # [-] added to J J^T: at a singularity the gradient is 0 instead of undefined


@dataclass(frozen=True, slots=True, kw_only=True)
class ManipulabilityFields(TaskFields):
    """Fields of `kind: manipulability`."""

    frame: str = declared("frame of the URDF", names="frame")
    axes: tuple[str, ...] = declared(
        "rows of the Jacobian, world axes", WORLD_AXES, domain=Distinct(POSE_ROWS), empty=False
    )
    reference: float | None = declared("standing value", None, unit="-")


@register_task("manipulability")
class ManipulabilityTask(Task):
    """m(q) = sqrt(det(J J^T)) of Yoshikawa (1985), J: chosen rows of a frame's Jacobian (r, a).

    J has the columns of the actuated joints. m is zero at a singularity; its unit is that of the
    rows (m^3 for a position). With column i of the full Jacobian (v_i, w_i) and
    B = (J J^T)^-1 J with columns (f_i, c_i),
        dm/dq_j = m (w_j . sum_{i >= j} (v_i x f_i + w_i x c_i) + v_j . sum_{i < j} f_i x w_i).
    The sums run along the chain of joints with one coordinate; the six of a base count as first.
    A reference that the robot cannot reach pushes it to the largest m that its other tasks allow.
    """

    entry: ClassVar[type[ManipulabilityFields]] = ManipulabilityFields
    error_unit = "-"

    def __init__(
        self,
        name: str,
        model: RobotModel,
        frame: str,
        stiffness: ArrayLike,
        damping: ArrayLike,
        axes: tuple[str, ...] = WORLD_AXES,
        reference: float | None = None,
    ) -> None:
        """See Task for the gains, of one row.

        Raises:
            UnknownName: no such frame; lists those that exist.
            InvalidValue: more rows than joints: m is 0 everywhere.
        """
        if len(axes) > model.na:
            raise InvalidValue(
                f"task '{name}': {len(axes)} axes given, at most {model.na} expected (one a joint)"
            )
        value = None if reference is None else [reference]
        super().__init__(name, ("manipulability",), stiffness, damping, value)
        self.frame = frame
        self._frame_id = model.frame_id(frame)
        self._rows = np.array([POSE_ROWS.index(axis) for axis in axes])

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> ManipulabilityTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(fields, cls.entry, names={"frame": model.frame_names}, rows=lambda _: 1)
        gains = given.stiffness, given.damping
        return cls(given.name, model, given.frame, *gains, given.axes, given.reference)

    def current(self, model: RobotModel) -> Array:
        """See Task; (1,)."""
        J = model.frame_jacobian(self._frame_id)[self._rows, model.nv - model.na :]
        return np.array([np.sqrt(max(np.linalg.det(J @ J.T), 0.0))])

    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:
        """See Task; the drift is the time derivative of the gradient, times v."""
        value = self.current(model)
        columns = model.frame_jacobian(self._frame_id)
        moved = _derivative(columns, model.v, model.nv - model.na)
        B, B_moved = self._inverse(columns, moved, model.nv - model.na)
        sums = _cross(columns[:3], B[:3]) + _cross(columns[3:], B[3:]), _cross(B[:3], columns[3:])
        sums_moved = (
            _cross(moved[:3], B[:3])
            + _cross(columns[:3], B_moved[:3])
            + _cross(moved[3:], B[3:])
            + _cross(columns[3:], B_moved[3:]),
            _cross(B_moved[:3], columns[3:]) + _cross(B[:3], moved[3:]),
        )
        slope = _along(columns, *sums)  # of log m
        slope_moved = _along(moved, *sums) + _along(columns, *sums_moved)
        rate = float(slope @ model.v)
        out.error[:] = reference.position - value
        out.jacobian[0] = value[0] * slope
        out.drift[0] = value[0] * (slope_moved @ model.v + rate * rate)

    def _inverse(self, columns: Array, moved: Array, base: int) -> tuple[Array, Array]:
        """B (6, n) with zeros outside of J, and its time derivative."""
        B, B_moved = np.zeros_like(columns), np.zeros_like(columns)
        J, J_moved = columns[self._rows, base:], moved[self._rows, base:]
        product = J @ J.T + _SINGULAR * np.eye(len(self._rows))
        inner = np.linalg.solve(product, J)
        turned = J_moved @ J.T
        B[self._rows, base:] = inner
        B_moved[self._rows, base:] = np.linalg.solve(
            product, J_moved - (turned + turned.T) @ inner
        )
        return B, B_moved


def _cross(a: Array, b: Array) -> Array:
    """Cross products of columns (3, n)."""
    return np.cross(a, b, axis=0)


def _along(columns: Array, from_here: Array, before: Array) -> Array:
    """w_j . sum_{i >= j} from_here_i + v_j . sum_{i < j} before_i, (n,)."""
    behind = np.cumsum(from_here[:, ::-1], axis=1)[:, ::-1]
    ahead = np.cumsum(before, axis=1) - before
    return np.asarray((columns[3:] * behind).sum(axis=0) + (columns[:3] * ahead).sum(axis=0))


def _derivative(columns: Array, velocity: Array, base: int) -> Array:
    """dJ/dt (6, n): v_i' = W_i x v_i + w_i x U_i, w_i' = W_i x w_i.

    W_i is the angular velocity of link i, U_i the velocity of the frame by the joints behind i.
    """
    turning = np.cumsum(columns[3:] * velocity, axis=1)
    moving = np.cumsum((columns[:3] * velocity)[:, ::-1], axis=1)[:, ::-1]
    behind = moving - columns[:3] * velocity
    if base:
        turning[:, :base] = turning[:, base - 1 : base]
        behind[:, :base] = moving[:, base : base + 1]
    linear = _cross(turning, columns[:3]) + _cross(columns[3:], behind)
    return np.vstack([linear, _cross(turning, columns[3:])])
