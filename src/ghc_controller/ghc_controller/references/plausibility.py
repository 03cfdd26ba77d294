"""Plausibility check of references: rejects values far outside any robot's range."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.model.limits import JointLimits
from ghc_controller.references.follower import Follower
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.types import Array

FARTHEST = 10.0  # [m] or [rad] from the origin, along one axis
FASTEST = 10.0  # [m/s] or [rad/s]
SHARPEST = 1000.0  # [m/s^2] or [rad/s^2]
STRONGEST = 2000.0  # [N] or [Nm]
LIMIT_MARGIN = 0.1  # [rad] by which the reference of a joint may exceed its limits


def check_plausible(
    task: Follower,
    reference: ReferenceTrajectory,
    limits: JointLimits,
    joint_names: Sequence[str],
) -> None:
    """Reject a reference that no robot of this kind could follow.

    Args:
        limits: of `joint_names`; references of posture tasks must be inside.

    Raises:
        InvalidValue: names the task, the field, what was given and expected.
    """
    fields: tuple[tuple[str, Array | None, float], ...] = (
        ("position", reference.position, FARTHEST),
        ("velocity", reference.velocity, FASTEST),
        ("acceleration", reference.acceleration, SHARPEST),
        ("wrench", reference.wrench, STRONGEST),
    )
    if set(task.labels) <= set(joint_names) and reference.position.shape[1] == len(task.labels):
        _check_joints(task, reference.position, limits, joint_names)
    for name, values, most in fields:
        if values is None:
            continue
        worst = float(values.flat[int(np.argmax(np.abs(values)))])
        if abs(worst) > most:
            raise InvalidValue(
                f"task '{task.name}', {name}: {worst:g} given, at most {most:g} expected"
            )


def _check_joints(
    task: Follower, position: Array, limits: JointLimits, joint_names: Sequence[str]
) -> None:
    places = [list(joint_names).index(label) for label in task.labels]
    lower = limits.position_lower[places] - LIMIT_MARGIN
    upper = limits.position_upper[places] + LIMIT_MARGIN
    outside = np.maximum(lower - position, position - upper)
    if (outside > 0.0).any():
        point, joint = np.unravel_index(int(np.argmax(outside)), outside.shape)
        raise InvalidValue(
            f"task '{task.name}', position: {position[point, joint]:g} rad given for "
            f"'{task.labels[joint]}', {lower[joint]:g} to {upper[joint]:g} rad expected"
        )
