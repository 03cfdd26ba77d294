"""Velocities of joints: a task without a position to go to."""

from __future__ import annotations

from collections.abc import Sequence
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
class JointVelocityFields(TaskFields):
    """Fields of `kind: joint_velocity`."""

    stiffness: tuple[float, ...] = declared(
        "has no effect", (0.0,), unit="1/s^2", domain=NOT_NEGATIVE, per_row=True
    )
    joints: tuple[str, ...] = declared(
        "rows of the task; left out = every joint", (), names="joint", empty=False
    )
    reference: tuple[float, ...] | None = declared(
        "standing velocity, one number per joint", None, unit="rad/s", per_row=True
    )


@register_task("joint_velocity")
class JointVelocityTask(Task):
    """Velocities of the named joints follow v* [rad/s]: v' = v*' + kd (v* - v).

    `position` of a reference is v* [rad/s], and its `velocity` is v*' [rad/s^2]. Without a
    reference v* = 0, which damps the joints.
    """

    entry: ClassVar[type[JointVelocityFields]] = JointVelocityFields
    error_unit = "rad/s"

    def __init__(
        self,
        name: str,
        model: RobotModel,
        damping: ArrayLike,
        joints: Sequence[str] | None = None,
        reference: ArrayLike | None = None,
    ) -> None:
        """See Task for `damping` [1/s]; `joints` defaults to every actuated joint.

        Raises:
            UnknownName: a joint that does not exist; lists those that do.
        """
        joints = model.joint_names if joints is None else tuple(joints)
        places = [model.nv - model.na + model.joint_index(joint) for joint in joints]
        still = np.zeros(len(joints)) if reference is None else reference
        labels = [f"{joint}/velocity" for joint in joints]  # a joint alone stands for a position
        super().__init__(name, labels, 0.0, damping, still)
        self._places = np.array(places, dtype=np.intp)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> JointVelocityTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(
            fields,
            cls.entry,
            names={"joint": model.joint_names},
            rows=lambda values: len(values["joints"] or model.joint_names),
        )
        return cls(given.name, model, given.damping, given.joints or None, given.reference)

    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:
        """See Task; the error v* - v [rad/s] is reported, and has no stiffness."""
        out.jacobian[np.arange(self.size), self._places] = 1.0
        out.error[:] = reference.position - model.v[self._places]
        out.acceleration[:] = reference.velocity
        out.velocity[:] = reference.position
        out.stiffness[:] = 0.0  # the error is one of velocity: tuned, it would damp twice

    def current(self, model: RobotModel) -> Array:
        """Velocities of the joints (m,) [rad/s]."""
        return model.v[self._places]

    def rest_target(self, model: RobotModel) -> TaskTarget:  # noqa: ARG002
        """No velocity: that of now would go on."""
        return self.static_target(np.zeros(self.size))
