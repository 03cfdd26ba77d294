"""Choices derived from a URDF: frames for two tasks, start posture, targets, missing limits."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array

FIRST_TORQUE, FIRST_VELOCITY = 50.0, 1.0  # [Nm] or [N], [rad/s] or [m/s], where a URDF has none
_SEED = 0
_POSTURES = 400  # random samples; the start is the one farthest from singular
_SPREAD = 0.8  # [rad] or [m] of these postures about the middle of the range
_INSIDE = 0.1  # [-] margin of the range at both ends
_MOVE = 0.35  # [rad] or [m] that joints move from the start to the posture of the targets
_WEAK = (1e-3, 1e-2)  # [m/rad] singular values of directions that a task can hardly move
_GRIPPER = 0.1  # [rad] or [m] range of a joint up to which it belongs to a gripper
FINGER = re.compile("finger|jaw|thumb", re.IGNORECASE)
TOOL = re.compile("tool|tcp|flange|hand|gripper|(^|_)eef?($|_)", re.IGNORECASE)


@dataclass(frozen=True)
class Choices:
    """Of one robot; all arrays in the order of the model's joints."""

    end_effector: str  # frame moved by most joints, preferably one named after a tool
    elbow: str  # frame moved by about half of them
    start: Array  # (a,) [rad] or [m]
    targets: tuple[Array, Array]  # (3,) [m] each: where both frames are in one other posture
    reach: float  # [m] largest distance of a frame from the base in the start posture
    weak: float  # [m/rad] a direction of the tasks that joints hardly move, 0 without one
    without_torque: tuple[str, ...]  # joints whose URDF has no torque limit
    without_velocity: tuple[str, ...]


def choose(model: RobotModel, start: Array | None = None) -> Choices:
    """Read a robot with a fixed base.

    Args:
        start: posture (a,) to begin in; one away from singular ones when not given.

    Raises:
        ConfigurationError: no frame that three joints move, or no suitable start posture.
    """
    rng = np.random.default_rng(_SEED)
    low, high = _range(model)
    middle = np.clip(np.zeros(model.na), low, high)
    movers = _movers(model, middle)
    best = max(movers.values(), default=0)
    if best < 3:
        raise ConfigurationError(
            f"no frame of the URDF is moved by three joints, at most {best}: give frames and "
            "tasks in a robot.yaml of your own (docs/own_robot.md)"
        )
    last = [name for name, count in movers.items() if count == best]
    last = [name for name in last if not FINGER.search(name)] or last
    end_effector = next((name for name in last if TOOL.search(name)), last[-1])
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
        _weak(model, start, (end_effector, elbow)),
        joints_without(model, model.torque_limit),
        joints_without(model, model.velocity_limit),
    )


def _range(model: RobotModel) -> tuple[Array, Array]:
    """Middle parts of the joints' ranges, each at most a turn wide."""
    low = np.maximum(model.position_lower, -np.pi)
    high = np.minimum(model.position_upper, np.pi)
    margin = _INSIDE * (high - low)
    return low + margin, high - margin


def _movers(model: RobotModel, q: Array) -> dict[str, int]:
    """Frame -> number of joints that move it, except those of a gripper; in the URDF's order."""
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


def _weak(model: RobotModel, q: Array, frames: tuple[str, str]) -> float:
    """Least singular value in _WEAK of a task, or of what one leaves of the other; 0 without."""
    model.update(q, np.zeros(model.nv))
    rows = [model.frame_jacobian(model.frame_id(name))[:3].copy() for name in frames]
    found = [np.linalg.svd(one, compute_uv=False) for one in rows]
    for first, second in (rows, rows[::-1]):
        rest = second - second @ np.linalg.pinv(first, _WEAK[0]) @ first
        found.append(np.linalg.svd(rest, compute_uv=False))
    weak = [value for value in np.concatenate(found) if _WEAK[0] < value < _WEAK[1]]
    return float(min(weak, default=0.0))


def _places(model: RobotModel, q: Array, frames: tuple[str, ...]) -> Array:
    """(k, 3) [m] origins of frames."""
    model.update(q, np.zeros(model.nv))
    return np.array([model.frame_position(model.frame_id(name)).copy() for name in frames])


def joints_without(model: RobotModel, limit: Array) -> tuple[str, ...]:
    """Joints whose limit (a,) is missing in the URDF."""
    return tuple(
        name for name, value in zip(model.joint_names, limit, strict=True) if not value > 0.0
    )
