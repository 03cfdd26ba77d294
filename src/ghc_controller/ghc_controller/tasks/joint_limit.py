"""Joint limits as a task: rows that switch on near a limit, and off again behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task, TaskFields
from ghc_controller.types import Array, TaskRows, TaskTarget


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLimitFields(TaskFields):
    """Fields of `kind: joint_limit`."""

    margin: float = declared(
        "of each limit, within which a row is on", unit="rad", domain=NOT_NEGATIVE
    )


@register_task("joint_limit")
class JointLimitTask(Task):
    """One row per joint, zero unless the joint is within `margin` [rad] of a limit.

    There it demands the edge of the margin, at rest: x = stiffness (edge - q) - damping v. It is
    the first level of Jeong and Chang (2009). Its rows come and go in one step, and so do torques;
    joints pass their limits by degrees where targets are far. The bounds of `position_limits` do
    neither.

    Fields: stiffness, damping, margin [rad]. It has no reference: one that is given changes
    nothing.
    """

    entry: ClassVar[type[JointLimitFields]] = JointLimitFields
    error_unit = "rad"

    def __init__(
        self,
        name: str,
        model: RobotModel,
        stiffness: ArrayLike,
        damping: ArrayLike,
        margin: float,
    ) -> None:
        """See Task for the gains."""
        super().__init__(name, model.joint_names, stiffness, damping)
        limits = model.limits
        self._lower, self._upper = limits.position_lower + margin, limits.position_upper - margin

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> JointLimitTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(fields, cls.entry, rows=lambda _: model.na)
        return cls(given.name, model, given.stiffness, given.damping, given.margin)

    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:  # noqa: ARG002
        """Rows of the joints beyond their edge, to come to rest there; all others are zero."""
        q = model.q[-model.na :]
        out.error[:] = np.clip(q, self._lower, self._upper) - q
        beyond = np.flatnonzero(out.error)
        out.jacobian[:] = 0.0
        out.jacobian[beyond, beyond + model.nv - model.na] = 1.0
        out.drift[:] = out.velocity[:] = out.acceleration[:] = 0.0

    def current(self, model: RobotModel) -> Array:
        """Positions of the joints now, (na,) [rad]."""
        return model.q[-model.na :]
