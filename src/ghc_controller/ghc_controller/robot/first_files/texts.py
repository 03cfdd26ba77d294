"""Templates of the first files of a robot: robot.yaml, scene, scenario; with comments for
editing."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence

import yaml

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.first_files.choices import FIRST_TORQUE, FIRST_VELOCITY, Choices
from ghc_controller.robot.first_files.legged import Stance
from ghc_controller.types import Array

SWAP = "swap"  # name of the scenario's file
_NULL_DAMPING = 5e-4  # [-] where a direction is weak; the default is 3e-5
_PLAIN = re.compile(r"[A-Za-z_./][\w./-]*")


def robot_text(name: str, urdf: str, model: RobotModel, chosen: Choices) -> str:
    """robot.yaml: limits that the URDF lacks, three tasks, an order."""
    return f"""\
# A first robot.yaml: change names of frames, gains and limits to your needs (docs/own_robot.md).
name: {scalar(name)}
urdf: {scalar(urdf)}
{limits_text(chosen)}tasks:                         # stiffness [1/s^2], damping [1/s]
  - name: end_effector
    kind: frame_position
    frame: {scalar(chosen.end_effector)}
    stiffness: 30.0
    damping: 20.0
  - name: elbow
    kind: frame_position
    frame: {scalar(chosen.elbow)}
    stiffness: 30.0
    damping: 20.0
  - name: posture
    kind: posture
    stiffness: 30.0
    damping: 20.0
    reference:                 # [rad] or [m]
{by_joint(model.joint_names, chosen.start, 6)}
hierarchy: end_effector > elbow > posture
{_settings(chosen)}"""


def scene_text(name: str, model: RobotModel, chosen: Choices) -> str:
    """The simulator's side: start posture and camera, in empty space."""
    return f"""\
# The robot in empty space; surfaces, contacts and obstacles go here (docs/own_robot.md).
name: {scalar(name)}
robot: ./robot.yaml

start:                         # [rad] or [m]
{by_joint(model.joint_names, chosen.start, 2)}

camera:
  look_at: [0.0, 0.0, {0.5 * chosen.reach:.2f}]   # [m]
  distance: {2.5 * chosen.reach:.2f}              # [m]
  azimuth: 130.0               # [deg]
  elevation: -15.0             # [deg]
"""


# Of every swap.yaml: files, period and times.
SWAP_TIMES = """\
robot: ./robot.yaml
scene: ./scene.yaml
control_dt: 0.001        # [s]
transition: 2.0          # [s] each ramp
hold: 6.0                # [s] after each ramp
torque_rate_limit: 1000.0   # [Nm/s]"""


def scenario_text(name: str, chosen: Choices) -> str:
    """Two tasks swap priorities; their targets are the frame positions in one other posture."""
    first, second = (", ".join(f"{value:.4f}" for value in target) for target in chosen.targets)
    return f"""\
# Two tasks change places, and back: `make run SCENARIO=.../{SWAP}.yaml`.
name: {scalar(f"{name}_{SWAP}")}
title: End effector and elbow change places
{SWAP_TIMES}

references:
  end_effector: {{position: [{first}]}}   # [m]
  elbow: {{position: [{second}]}}   # [m]

phases:
  - hierarchy: end_effector > elbow > posture
  - hierarchy: elbow > end_effector > posture
  - hierarchy: end_effector > elbow > posture
"""


def _settings(chosen: Choices) -> str:
    """A weak direction creeps for minutes unless the posture below may hold it."""
    if not chosen.weak:
        return ""
    return f"""\
settings:
  # A direction of the tasks moves by {chosen.weak:.1g} m per rad: the posture shall hold it.
  null_damping: {_NULL_DAMPING}
"""


def scalar(text: str) -> str:
    """A string in YAML, quoted if it would be read as another type, such as 1 or on."""
    plain = _PLAIN.fullmatch(text) and yaml.safe_load(text) == text
    return text if plain else json.dumps(text, ensure_ascii=False)


def by_joint(names: Sequence[str], values: Array, indent: int) -> str:
    """Lines of a mapping joint: value."""
    pad = " " * indent
    return "\n".join(
        f"{pad}{scalar(name)}: {value:.3f}" for name, value in zip(names, values, strict=True)
    )


def limits_text(chosen: Choices | Stance) -> str:
    """The section `limits`, where the URDF lacks some; else nothing."""
    missing: Mapping[str, tuple[Sequence[str], float, str]] = {
        "torque": (chosen.without_torque, FIRST_TORQUE, "[Nm] or [N]"),
        "velocity": (chosen.without_velocity, FIRST_VELOCITY, "[rad/s] or [m/s]"),
    }
    lines = []
    for field, (names, value, unit) in missing.items():
        if names:
            joints = ", ".join(f"{scalar(name)}: {value:g}" for name in names)
            lines.append(f"  {field}: {{{joints}}}  # {unit} CHECK: the URDF has none")
    return "\n".join(["limits:", *lines]) + "\n" if lines else ""
