"""What deceleration torque limits and gravity leave to each joint, over poses within its limits.

    held:  (tau_max - |g_j|) / M_jj      all other joints keep their motion
    free:  (tau_max - |g_j|) (M^-1)_jj   they follow without torque: more is not possible

A position limit plans with `brake_acceleration` (`JointPositionLimit`). More than `free` at every
pose cannot be kept; more than `held` at some pose is kept only while other joints yield.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array

POSES = 33  # the middle of all ranges, and random ones
_SEED = 0
_TURN = np.pi  # [rad] or [m] of a joint without a limit, to both sides


@dataclass(frozen=True, slots=True)
class Deceleration:
    """Over all poses, per joint, (a,) [rad/s^2] or [m/s^2]; negative: gravity is too much."""

    least_held: Array
    most_free: Array
    gravity: Array  # [Nm] or [N] the least magnitude


def deceleration(model: RobotModel) -> Deceleration:
    """With a floating base the limbs hang from it. The state of the model stays."""
    q, v, a = model.q.copy(), model.v.copy(), model.na
    lower, upper = model.position_lower, model.position_upper
    lower = np.where(np.isfinite(lower), lower, -_TURN)
    upper = np.where(np.isfinite(upper), upper, _TURN)
    poses = np.random.default_rng(_SEED).uniform(lower, upper, (POSES, a))
    poses[0] = 0.5 * (lower + upper)
    gravity, masses, rest = np.empty((POSES, a)), [], np.zeros_like(v)
    for k, pose in enumerate(poses):
        dynamics = model.update(np.concatenate([q[:-a], pose]), rest)
        masses.append(dynamics.mass_matrix.copy())
        gravity[k] = np.abs(model.gravity()[-a:])
    model.update(q, v)
    mass = np.array(masses)  # (POSES, n, n)
    left = model.torque_limit - gravity
    held = left / np.diagonal(mass, axis1=1, axis2=2)[:, -a:]
    free = left * np.diagonal(np.linalg.inv(mass), axis1=1, axis2=2)[:, -a:]
    return Deceleration(held.min(axis=0), free.max(axis=0), gravity.min(axis=0))


def check_brakes(model: RobotModel, brake_acceleration: float) -> None:
    """Check that no joint brakes harder than its torque limit allows at the best pose.

    Raises:
        InvalidValue: names the first such joint, with numbers.
    """
    found = deceleration(model)
    for j in np.flatnonzero(found.most_free < brake_acceleration):
        raise InvalidValue(
            f"{brake_acceleration:g} rad/s^2 given, at most {max(found.most_free[j], 0.0):.3g} "
            f"expected: joint '{model.joint_names[j]}' decelerates no harder at any of {POSES} "
            f"poses within its limits (torque limit {model.torque_limit[j]:g} Nm, of which "
            f"gravity takes {found.gravity[j]:.3g} Nm or more)"
        )
