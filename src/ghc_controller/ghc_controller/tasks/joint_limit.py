"""Joint limits as a task: rows that switch on near a limit, and off again behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from numpy.typing import ArrayLike

from ghc_controller.core import EdgeMeasure
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.compiled import CompiledTask
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import TaskFields
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLimitFields(TaskFields):
    """Fields of `kind: joint_limit`."""

    margin: float = declared(
        "of each limit, within which a row is on", unit="rad", domain=NOT_NEGATIVE
    )


@register_task("joint_limit")
class JointLimitTask(CompiledTask):
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
        limits = model.limits
        core = EdgeMeasure(limits.position_lower + margin, limits.position_upper - margin)
        super().__init__(name, model.joint_names, stiffness, damping, core)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> JointLimitTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(fields, cls.entry, rows=lambda _: model.na)
        return cls(given.name, model, given.stiffness, given.damping, given.margin)

    def current(self, model: RobotModel) -> Array:
        """Positions of the joints now, (na,) [rad]."""
        return model.q[-model.na :]
