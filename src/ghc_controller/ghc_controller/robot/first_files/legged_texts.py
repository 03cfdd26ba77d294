"""Texts of the first files of a legged robot: robot.yaml, scene, scenario."""

from __future__ import annotations

import math

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.first_files.feet import Foot
from ghc_controller.robot.first_files.legged import Stance
from ghc_controller.robot.first_files.texts import SWAP, SWAP_TIMES, by_joint, limits_text, scalar
from ghc_controller.types import Array

_POINT_RADIUS, _SOLE_RADIUS = 0.001, 0.005  # [m] a small ball hardly rolls as the leg turns
_LENGTH = 1.2  # [m] for a quadruped, which is longer than high
_SHARE = 2.0  # [-] of the weight that each foot may carry


def robot_text(name: str, urdf: str, model: RobotModel, stance: Stance) -> str:
    """robot.yaml: a floating base, contacts of the feet, tasks of balance, an order."""
    hand = ""
    if stance.hand:
        hand = f"""\
  - name: hand
    kind: frame_position
    frame: {scalar(stance.hand)}
    stiffness: 60.0
    damping: 16.0
"""
    return f"""\
# A first robot.yaml: change frames, gains, limits and contacts to your needs (docs/own_robot.md).
name: {scalar(name)}
urdf: {scalar(urdf)}
floating_base: true
{limits_text(stance)}tasks:                         # stiffness [1/s^2], damping [1/s]
  - name: center_of_mass
    kind: center_of_mass
    stiffness: 60.0
    damping: 16.0
  - name: base_orientation
    kind: frame_orientation
    frame: {scalar(stance.base)}
    stiffness: 100.0
    damping: 20.0
{hand}  - name: posture
    kind: posture
    stiffness: 40.0
    damping: 12.6
    reference:                 # [rad] or [m]
{by_joint(model.joint_names, stance.start, 6)}
contacts:                      # CHECK the points: where the shapes of the feet end
{_contacts(model, stance)}
hierarchy: {_order(stance)}
"""


def scene_text(name: str, model: RobotModel, stance: Stance) -> str:
    """The simulator's side: standing on the floor."""
    feet = ", ".join(scalar(foot.frame) for foot in stance.feet)
    contacts = "".join(
        f"  - {{name: {scalar(foot.frame)}, radius: {_radius(foot)}, inward: {_vector(foot.up)}, "
        "friction: 0.8, time_constant: 0.02}\n"
        for foot in stance.feet
    )
    return f"""\
# The robot on the floor; other surfaces and obstacles go here (docs/own_robot.md).
name: {scalar(name)}
robot: ./robot.yaml

base:
  stand_on: [{feet}]
  level: {scalar(stance.base)}
  at: [0.0, 0.0, {stance.height:.4f}]   # [m] mean of the origins of these frames

start:                         # [rad] or [m]
{by_joint(model.joint_names, stance.start, 2)}

surfaces:
  - {{name: floor, kind: plane}}

contacts:                      # balls [m] at the points of robot.yaml
{contacts}
camera:
  look_at: [0.0, 0.0, {stance.size:.2f}]   # [m]
  distance: {max(4.0 * stance.size, stance.size + _LENGTH):.2f}              # [m]
  azimuth: 145.0               # [deg]
  elevation: -12.0             # [deg]
"""


def scenario_text(name: str, stance: Stance) -> str:
    """Balance and a second task change places, and back."""
    half = 0.5 * stance.pitch
    second = f"  hand: {{position: {_vector(stance.hand_target)}}}   # [m]"
    if not stance.hand:
        second = (
            f"  base_orientation: {{position: [0.0, {math.sin(half):.5f}, 0.0, "
            f"{math.cos(half):.5f}]}}   # quaternion x, y, z, w"
        )
    order, other = _order(stance), _swapped(stance)
    return f"""\
# Balance and {_second(stance)} change places, and back: `make run SCENARIO=.../{SWAP}.yaml`.
name: {scalar(f"{name}_{SWAP}")}
title: Center of mass and {_second(stance)} change places
{SWAP_TIMES}

references:
  center_of_mass: {{position: {_vector(stance.center_target)}}}   # [m]
{second}

phases:
  - hierarchy: {order}
  - hierarchy: {other}
  - hierarchy: {order}
"""


def _radius(foot: Foot) -> float:
    return _POINT_RADIUS if len(foot.points) == 1 else _SOLE_RADIUS


def _second(stance: Stance) -> str:
    return "hand" if stance.hand else "base_orientation"


def _order(stance: Stance) -> str:
    hand = " > hand" if stance.hand else ""
    return f"center_of_mass > base_orientation{hand} > posture"


def _swapped(stance: Stance) -> str:
    if stance.hand:
        return "hand > base_orientation > center_of_mass > posture"
    return "base_orientation > center_of_mass > posture"


def _contacts(model: RobotModel, stance: Stance) -> str:
    upper = math.ceil(_SHARE * model.weight / 10.0) * 10.0
    return "".join(
        f"""\
  - name: {scalar(foot.frame)}
    frame: {scalar(foot.frame)}
    points: [{", ".join(_vector(point) for point in foot.points)}]   # [m]
    normal: [0, 0, 1]
    friction: 0.6
    force_upper: {upper:.1f}   # [N]
    active: true
"""
        for foot in stance.feet
    )


def _vector(values: Array) -> str:
    return f"[{', '.join(f'{value:.5f}' for value in np.asarray(values) + 0.0)}]"
