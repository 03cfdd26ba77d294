"""Postures that the SRDF of a robot names: its `group_state` elements."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array


def group_state(file: Path, model: RobotModel, name: str = "") -> Array:
    """Joint positions (a,) [rad] or [m] of a group state; joints that it leaves out are at zero.

    Args:
        name: of the state; empty = the one that names most joints of the model, the first of
            several.

    Raises:
        ConfigurationError: the file cannot be read, or has no state of a joint of the model.
        UnknownName: no state of that name; lists those of the file.
    """
    states = _states(file, model)
    if name and name not in states:
        raise UnknownName(f"group state of {file}", name, states)
    chosen = states[name] if name else max(states.values(), key=len, default={})
    if not chosen:
        raise ConfigurationError(f"{file}: no group_state of a joint of the robot")
    start = np.zeros(model.na)
    for joint, value in chosen.items():
        start[model.joint_index(joint)] = value
    return np.clip(start, model.position_lower, model.position_upper)


def _states(file: Path, model: RobotModel) -> dict[str, dict[str, float]]:
    """State -> joint -> value, of joints of one coordinate that the model has."""
    try:
        robot = ElementTree.parse(file).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise ConfigurationError(f"{file}: cannot be read as an SRDF: {error}") from error
    found: dict[str, dict[str, float]] = {}
    for state in robot.iterfind("group_state"):
        joints = found.setdefault(state.get("name", ""), {})
        for joint in state.iterfind("joint"):
            name, text = joint.get("name", ""), joint.get("value", "")
            if name in model.joint_names:
                joints[name] = _number(text, f"{file}: joint '{name}'")
    return found


def _number(text: str, where: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise ConfigurationError(f"{where}: a number expected, '{text}' given") from error
