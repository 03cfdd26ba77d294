"""What a URDF suggests: frames for two tasks, start posture, targets, limits that are missing."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array

FIRST_TORQUE, FIRST_VELOCITY = 50.0, 1.0  # [Nm] or [N], [rad/s] or [m/s], where a URDF has none
_SEED = 0
_POSTURES = 400  # drawn, of which the start is the one farthest from singular
_SPREAD = 0.8  # [rad] or [m] of these postures about the middle of the range
_INSIDE = 0.1  # [-] of the range that stays free at both ends
_MOVE = 0.35  # [rad] or [m] that joints move from the start to the posture of the targets
_GRIPPER = 0.1  # [rad] or [m] range of a joint up to which it belongs to a gripper
_FINGER = re.compile("finger|jaw|thumb", re.IGNORECASE)
_TOOL = re.compile("tool|tcp|flange|hand|gripper|(^|_)eef?($|_)", re.IGNORECASE)


@dataclass(frozen=True)
class Choices:
    """Of one robot; all arrays in the order of the model's joints."""

    end_effector: str  # frame that most joints carry, one named after a tool if there is one
    elbow: str  # frame that about half of them carry
    start: Array  # (a,) [rad] or [m]
    targets: tuple[Array, Array]  # (3,) [m] each: where both frames are in one other posture
    reach: float  # [m] largest distance of a frame from the base in the start posture
    without_torque: tuple[str, ...]  # joints whose URDF has no torque limit
    without_velocity: tuple[str, ...]


def choose(model: RobotModel, start: Array | None = None) -> Choices:
    """Read a robot with a fixed base.

    Args:
        start: posture (a,) to begin in; one away from singular ones when not given.

    Raises:
        ConfigurationError: no frame that three joints move, or nothing that one could start from.
    """
    rng = np.random.default_rng(_SEED)
    low, high = _range(model)
    middle = np.clip(np.zeros(model.na), low, high)
    movers = _movers(model, middle)
    best = max(movers.values(), default=0)
    if best < 3:
        raise ConfigurationError(
            f"no frame of the URDF is carried by three joints, at most {best}: give frames and "
            "tasks in a robot.yaml of your own (docs/own_robot.md)"
        )
    last = [name for name, count in movers.items() if count == best]
    last = [name for name in last if not _FINGER.search(name)] or last
    end_effector = next((name for name in last if _TOOL.search(name)), last[-1])
    half = min(movers.values(), key=lambda count: abs(count - (best + 1) / 2) + (count >= best))
    elbow = next(name for name in movers if movers[name] == half)
    drawn = np.clip(rng.uniform(-_SPREAD, _SPREAD, (_POSTURES, model.na)) + middle, low, high)
    if start is None:
        start = max(drawn, key=lambda q: _regularity(model, q, end_effector))
    other = np.clip(start + _MOVE * rng.choice([-1.0, 1.0], model.na), low, high)
    targets = _places(model, other, (end_effector, elbow))
    places = _places(model, start, tuple(movers))
    return Choices(
        end_effector,
        elbow,
        start,
        (targets[0], targets[1]),
        float(np.linalg.norm(places, axis=1).max()),
        _without(model, model.torque_limit),
        _without(model, model.velocity_limit),
    )


def _range(model: RobotModel) -> tuple[Array, Array]:
    """Middle parts of the joints' ranges, each at most a turn wide."""
    low = np.maximum(model.position_lower, -np.pi)
    high = np.minimum(model.position_upper, np.pi)
    margin = _INSIDE * (high - low)
    return low + margin, high - margin


def _movers(model: RobotModel, q: Array) -> dict[str, int]:
    """Frame -> number of joints that carry it, those of a gripper aside; in the URDF's order."""
    model.update(q, np.zeros(model.nv))
    arm = model.position_upper - model.position_lower > _GRIPPER
    counts = {}
    for name in model.frame_names:
        jacobian = model.frame_jacobian(model.frame_id(name))
        counts[name] = int(np.sum(arm & (np.abs(jacobian).max(axis=0) > 0.0)))
    return counts


def _regularity(model: RobotModel, q: Array, frame: str) -> float:
    """Least singular value of the frame's position Jacobian."""
    model.update(q, np.zeros(model.nv))
    jacobian = model.frame_jacobian(model.frame_id(frame))[:3]
    return float(np.linalg.svd(jacobian, compute_uv=False)[-1])


def _places(model: RobotModel, q: Array, frames: tuple[str, ...]) -> Array:
    """(k, 3) [m] origins of frames."""
    model.update(q, np.zeros(model.nv))
    return np.array([model.frame_position(model.frame_id(name)).copy() for name in frames])


def _without(model: RobotModel, limit: Array) -> tuple[str, ...]:
    return tuple(
        name for name, value in zip(model.joint_names, limit, strict=True) if not value > 0.0
    )
