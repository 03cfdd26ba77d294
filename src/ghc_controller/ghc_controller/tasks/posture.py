"""Positions of joints, chosen by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.core import JointMeasure
from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.compiled import CompiledTask
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import TaskFields
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureFields(TaskFields):
    """Fields of `kind: posture`."""

    reference: float | Mapping[str, float] | None = declared(
        "standing positions: a number, or joint: number; these joints are then the rows",
        None,
        unit="rad",
    )
    joints: tuple[str, ...] = declared(
        "rows of the task; left out = those of the reference, else every joint",
        (),
        names="joint",
        empty=False,
    )


@register_task("posture")
class PostureTask(CompiledTask):
    """xi = positions of the named joints [rad]; `labels` are the joints, in the given order.

    Fields: stiffness, damping, reference (optional mapping joint -> position; its joints are the
    rows of the task, in the model's order), joints (optional list, default: those of the
    reference, else every joint).
    """

    entry: ClassVar[type[PostureFields]] = PostureFields
    error_unit = "rad"

    def __init__(
        self,
        name: str,
        model: RobotModel,
        stiffness: ArrayLike,
        damping: ArrayLike,
        joints: Sequence[str] | None = None,
        reference: ArrayLike | None = None,
    ) -> None:
        """See Task for the gains; `joints` defaults to every actuated joint.

        Raises:
            UnknownName: a joint that does not exist; lists those that do.
        """
        joints = model.joint_names if joints is None else tuple(joints)
        indices = [model.joint_index(joint) for joint in joints]
        super().__init__(name, joints, stiffness, damping, JointMeasure(indices), reference)
        self._q_indices = np.array(indices) + (model.nq - model.na)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> PostureTask:
        """Build from one entry of `tasks` in robot.yaml."""
        joint_names = model.joint_names

        def joints_of(values: Mapping[str, Any]) -> tuple[str, ...]:
            given = values["reference"]
            named = given if isinstance(given, Mapping) else joint_names
            return values["joints"] or tuple(joint for joint in joint_names if joint in named)

        given = read(
            fields, cls.entry, names={"joint": joint_names}, rows=lambda v: len(joints_of(v))
        )
        reference = given.reference
        joints = joints_of({"joints": given.joints, "reference": reference})
        position = None
        if isinstance(reference, Mapping):
            if not reference:
                raise fields.error("reference", "at least one joint expected, none given")
            for joint in reference:
                if joint not in joint_names:
                    raise fields.error(
                        f"reference.{joint}", f"unknown joint; known: {', '.join(joint_names)}"
                    )
            missing = [joint for joint in joints if joint not in reference]
            if missing:
                raise fields.error("reference", f"joint '{missing[0]}' missing")
            position = np.array([reference[joint] for joint in joints])
        elif reference is not None:
            position = np.full(len(joints), reference)
        if position is not None:
            _check_range(fields, model, joints, position)
        return cls(given.name, model, given.stiffness, given.damping, joints, position)

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """Zero: joint positions are linear in themselves."""
        del weights
        return np.zeros((model.nv, model.nv))

    def current(self, model: RobotModel) -> Array:
        """Positions of the joints now, (m,) [rad]."""
        return model.q[self._q_indices]

    def ordered(self, joints: Sequence[str], values: Array) -> Array:
        """Columns of `values` (..., m) given in the order of `joints`, put into task order.

        Raises:
            InvalidValue: the joints are not exactly those of the task.
        """
        if sorted(joints) != sorted(self.labels):
            raise InvalidValue(
                f"task '{self.name}', joints: {list(joints)} given, {list(self.labels)} expected"
            )
        return np.asarray(values)[..., [list(joints).index(joint) for joint in self.labels]]


def _check_range(
    fields: Fields, model: RobotModel, joints: tuple[str, ...], position: Array
) -> None:
    """Raise ConfigurationError for a reference beyond a position limit, as of degrees."""
    for joint, value in zip(joints, position, strict=True):
        k = model.joint_index(joint)
        lower, upper = model.position_lower[k], model.position_upper[k]
        if not lower <= value <= upper:
            raise fields.error(
                "reference",
                f"{value:g} for joint '{joint}' is beyond its limits, {lower:g} to {upper:g}; "
                "radians (or meters) expected",
            )
