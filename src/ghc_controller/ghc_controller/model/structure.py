"""What of a robot model does not move: its file, its joints, their order and limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ghc_controller.errors import ConfigurationError
from ghc_controller.model.limits import JointLimits

_FREE_FLYER_NV = 6  # velocity coordinates of a floating base: linear, angular in base axes


def read_urdf(path: Path, floating_base: bool) -> pin.Model:
    """Model of a URDF, behind a free flyer if its base floats.

    Raises:
        ConfigurationError: the file does not exist or is no URDF.
    """
    if not path.is_file():
        raise ConfigurationError(f"{path}: robot model does not exist")
    root = (pin.JointModelFreeFlyer(),) if floating_base else ()
    try:
        return pin.buildModelFromUrdf(str(path), *root)
    except (ValueError, RuntimeError) as error:
        raise ConfigurationError(f"{path}: not a readable URDF: {error}") from error


def has_floating_base(model: pin.Model) -> bool:
    """Whether the first joint is a free flyer."""
    return bool(model.njoints > 1 and model.joints[1].nv == _FREE_FLYER_NV)


def actuated_joints(model: pin.Model) -> tuple[str, ...]:
    """Names of the joints behind the base.

    Raises:
        ConfigurationError: there is none, or one has several coordinates (among them URDF
            `continuous` joints, whose angle Pinocchio stores as cosine and sine).
    """
    names = tuple(model.names)[2 if has_floating_base(model) else 1 :]
    if not names:
        raise ConfigurationError(f"model '{model.name}' has no actuated joint")
    for name in names:
        if model.joints[model.getJointId(name)].nq != 1:
            raise ConfigurationError(
                f"joint '{name}' has several coordinates; revolute joints with limits and"
                " prismatic joints are supported (not 'continuous' ones)"
            )
    return names


def model_limits(model: pin.Model, na: int) -> JointLimits:
    """Limits of the last `na` joints as the model file states them."""
    return JointLimits(
        np.array(model.lowerPositionLimit[-na:]),
        np.array(model.upperPositionLimit[-na:]),
        np.array(model.upperVelocityLimit[-na:]),
        np.array(model.upperEffortLimit[-na:]),
    )


def joint_order(model: pin.Model) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """`joint_of` (n,) and `carries` (n, n) of RobotModel."""
    joint_of = np.zeros(model.nv, dtype=np.int64)
    for joint in range(1, model.njoints):
        first = model.joints[joint].idx_v
        joint_of[first : first + model.joints[joint].nv] = joint
    carries = np.zeros((model.nv, model.nv), dtype=np.bool_)
    for b in range(model.nv):
        carries[:, b] = np.isin(joint_of, list(model.supports[int(joint_of[b])]))
    return joint_of, carries
