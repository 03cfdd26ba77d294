"""What the URDF of a legged robot suggests: how it stands, contacts, tasks and their targets."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.first_files.choices import FINGER, TOOL, joints_without
from ghc_controller.robot.first_files.feet import Foot, find_feet, movers, shapes_of
from ghc_controller.robot.first_files.standing import standing_posture
from ghc_controller.types import Array

_SINK = 0.0005  # [m] by which feet sink into the ground under the weight
_ARM = 3  # [-] joints that carry a hand at least
_MOVE = 0.2  # [rad] that the joints of the arm move to the posture of the hand's target
_CENTER = (0.02, 0.0, -0.01)  # [m] move of the center of mass
_PITCH = 0.08  # [rad] of the base


@dataclass(frozen=True)
class Stance:
    """Of one legged robot; places in the world, in which the base is level and faces +x."""

    base: str  # link that floats
    feet: tuple[Foot, ...]  # as the robot stands
    height: float  # [m] mean of the feet's frames above the ground
    start: Array  # (a,) [rad]
    hand: str  # frame at the end of an arm; empty where the robot has none
    center_target: Array  # (3,) [m]
    hand_target: Array  # (3,) [m]; zeros without a hand
    pitch: float  # [rad] target of the base, where there is no hand
    size: float  # [m] height of the center of mass
    without_torque: tuple[str, ...]  # joints whose URDF has no torque limit
    without_velocity: tuple[str, ...]


def choose_stance(urdf: Path, model: RobotModel, start: Array | None = None) -> Stance | None:
    """How a robot with a floating base stands; None where it has no legs.

    Args:
        start: posture (a,) of an SRDF; one with bent knees is looked for when not given.

    Raises:
        ConfigurationError: a mesh cannot be read, or no posture was found in which it stands.
    """
    first = model.nq - model.na
    q = np.array(model.q)
    zero = np.clip(np.zeros(model.na), model.position_lower, model.position_upper)
    q[first:] = zero if start is None else start
    feet = find_feet(model, shapes_of(urdf, model, q), q)
    if not feet:
        return None
    if start is None:
        start = q[first:] = standing_posture(model, feet, q)
        feet = find_feet(model, shapes_of(urdf, model, q), q) or feet
    base = next(name for name in model.frame_names if not movers(model, name))
    model.update(q, np.zeros(model.nv))
    ids = [model.frame_id(foot.frame) for foot in feet]
    bottom = np.mean([_bottom(model, foot) for foot in feet])
    middle = np.mean([model.frame_position(index) for index in ids], axis=0)
    shift = np.array([-middle[0], -middle[1], -bottom - _SINK])
    center = model.center_of_mass() + shift
    hand = _hand(model, feet)
    target = np.zeros(3)
    if hand:
        moved = q.copy()
        columns = sorted(movers(model, hand))
        moved[[first + column - (model.nv - model.na) for column in columns[-_ARM:]]] += _MOVE
        moved[first:] = np.clip(moved[first:], model.position_lower, model.position_upper)
        model.update(moved, np.zeros(model.nv))
        target = model.frame_position(model.frame_id(hand)) + shift
    return Stance(
        base,
        feet,
        float(middle[2] + shift[2]),
        start,
        hand,
        center + np.array(_CENTER) * min(1.0, center[2] / 0.5),
        target,
        0.0 if hand else _PITCH,
        float(center[2]),
        joints_without(model, model.torque_limit),
        joints_without(model, model.velocity_limit),
    )


def _bottom(model: RobotModel, foot: Foot) -> float:
    """Height [m] of a foot's points in base axes."""
    index = model.frame_id(foot.frame)
    points = foot.points @ model.frame_rotation(index).T + model.frame_position(index)
    return float(points[:, 2].mean())


def _hand(model: RobotModel, feet: tuple[Foot, ...]) -> str:
    """Frame that most joints carry which carry no foot; one named after a tool if there is one."""
    legs = frozenset().union(*(foot.joints for foot in feet))
    counts = {}
    for name in model.frame_names:
        joints = movers(model, name)
        if joints and not joints & legs and not FINGER.search(name):
            counts[name] = len(joints)
    most = max(counts.values(), default=0)
    if most < _ARM:
        return ""
    last = [name for name, count in counts.items() if count == most]
    return next((name for name in last if TOOL.search(name)), last[-1])
