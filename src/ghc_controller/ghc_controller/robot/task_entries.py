"""Tasks of a robot that is written in Python: the entries of `tasks` in robot.yaml, as values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

Gain = float | list[float]


@dataclass(frozen=True)
class TaskEntry:
    """One task of any registered kind; fields are checked when the robot is made.

    `fields` are those of robot.yaml (docs/own_robot.md), such as frame or axes.
    """

    kind: str
    name: str
    stiffness: Gain  # [1/s^2], one number or one per row
    damping: Gain  # [1/s]
    fields: Mapping[str, Any] = field(default_factory=dict)

    def as_mapping(self) -> dict[str, Any]:
        """The entry as in robot.yaml."""
        own = {"kind": self.kind, "name": self.name}
        return {**own, "stiffness": self.stiffness, "damping": self.damping, **self.fields}


def frame_position(
    name: str, frame: str, stiffness: Gain, damping: Gain, **fields: Any
) -> TaskEntry:
    """Position of a frame's origin [m]; fields: axes, reference, force."""
    return TaskEntry("frame_position", name, stiffness, damping, {"frame": frame, **fields})


def frame_orientation(
    name: str, frame: str, stiffness: Gain, damping: Gain, **fields: Any
) -> TaskEntry:
    """Rotation of a frame [rad]; fields: reference."""
    return TaskEntry("frame_orientation", name, stiffness, damping, {"frame": frame, **fields})


def frame_pose(name: str, frame: str, stiffness: Gain, damping: Gain, **fields: Any) -> TaskEntry:
    """Position, then rotation of a frame; fields: reference."""
    return TaskEntry("frame_pose", name, stiffness, damping, {"frame": frame, **fields})


def posture(name: str, stiffness: Gain, damping: Gain, **fields: Any) -> TaskEntry:
    """Joint positions [rad]; fields: joints, reference."""
    return TaskEntry("posture", name, stiffness, damping, fields)


def center_of_mass(name: str, stiffness: Gain, damping: Gain, **fields: Any) -> TaskEntry:
    """Center of mass [m]; fields: axes, reference."""
    return TaskEntry("center_of_mass", name, stiffness, damping, fields)
