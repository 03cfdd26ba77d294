"""Where on the robot contacts are, and what of a task can be drawn at a place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.robot.robot import Robot
from ghc_controller.tasks.python.frame_avoidance import FrameAvoidanceTask
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array

_AXES = ("x", "y", "z")


class Site(NamedTuple):
    """A contact: points of a frame."""

    frame_id: int  # of the robot model
    points: Array  # (p, 3) [m] in the frame


class Target(NamedTuple):
    """A task's reference as something in the world."""

    position: Array  # (3,) [m]
    actual: Array  # (3,) [m] where that of the robot is now
    quaternion: Array | None  # x, y, z, w; None where the task has no orientation
    is_obstacle: bool  # the task keeps away from it


def contact_sites(robot: Robot) -> dict[str, Site]:
    """Contacts by name: of the robot's file, and of its force control."""
    model = robot.model
    sites: dict[str, Site] = {}
    for task in robot.tasks:
        if task.force is not None and hasattr(task, "frame"):
            frame = model.frame_id(task.frame)
            sites.setdefault(task.force.contact, Site(frame, np.zeros((1, 3))))
    for contact in robot.contacts:
        sites[contact.name] = Site(contact.frame_id, contact.points)
    return sites


def site_points(site: Site, model: RobotModel) -> Array:
    """Points (p, 3) [m] of a contact in the world at the last `model.update`."""
    frame = model.frame(site.frame_id)
    return frame.position + site.points @ frame.rotation.T


def target_of(task: Task, reference: Sequence[float], model: RobotModel) -> Target | None:
    """What to draw of a reference; None for what is not in the world, such as a posture.

    A task of some axes only has the robot's own coordinates on the others.
    """
    values = np.array(reference)
    if values.shape != (task.position_size,):
        return None
    actual = _place(task, model)
    if actual is None:
        return None
    if isinstance(task, FrameAvoidanceTask):
        return Target(values, actual, None, True)
    if task.space is ReferenceSpace.POSE:
        return Target(values[:3], actual, values[3:], False)
    if task.space is ReferenceSpace.ORIENTATION:
        return Target(actual, actual, values, False)
    if not set(task.labels) <= set(_AXES):
        return None
    position = actual.copy()
    position[[_AXES.index(axis) for axis in task.labels]] = values
    return Target(position, actual, None, False)


def removed_tasks(names: Sequence[str], alpha: Sequence[float]) -> Mapping[str, bool]:
    """Whether each task is off in a row-major matrix of priorities."""
    matrix = np.array(alpha)
    if matrix.size != len(names) ** 2:
        return dict.fromkeys(names, False)
    diagonal = matrix.reshape(len(names), -1).diagonal()
    return {name: bool(value >= 1.0) for name, value in zip(names, diagonal, strict=True)}


def _place(task: Task, model: RobotModel) -> Array | None:
    """Position (3,) [m] of what a task moves."""
    frame = getattr(task, "frame", None)
    if isinstance(frame, str):
        return model.frame_position(model.frame_id(frame)).copy()
    return model.center_of_mass() if set(task.labels) <= set(_AXES) else None
