"""Whether a configuration is within the position limits of its joints."""

from __future__ import annotations

import numpy as np

from ghc_controller.errors import OutsideLimits
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array


def check_limits(model: RobotModel, q: Array, tolerance: float = 1e-6) -> None:
    """Raise an error for the joint that is farthest outside its position limits.

    A floating base has none. The model is not updated.

    Args:
        q: (nq,) configuration.
        tolerance: [rad] or [m] outside of a limit that is accepted.

    Raises:
        OutsideLimits: with the joint, its value and its limits.
    """
    joints = np.asarray(q)[model.nq - model.na :]
    lower, upper = model.limits.position_lower, model.limits.position_upper
    excess = np.maximum(lower - joints, joints - upper)
    worst = int(np.argmax(np.where(np.isnan(excess), np.inf, excess)))
    if not excess[worst] <= tolerance:  # also for NaN
        name = model.joint_names[worst]
        raise OutsideLimits(name, float(joints[worst]), float(lower[worst]), float(upper[worst]))
