"""Markers of targets, contacts, forces, obstacles and environment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from builtin_interfaces.msg import Time
from ghc_msgs.msg import ControllerState, ObstacleState
from visualization_msgs.msg import MarkerArray

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.rotation import matrix_from_quaternion
from ghc_controller.robot.robot import Robot
from ghc_controller.types import Array
from ghc_sim_bridge.colors import BOUND, MEASURED, PALETTE, color, rgba
from ghc_sim_bridge.display.sites import (
    Target,
    contact_sites,
    removed_tasks,
    site_points,
    target_of,
)
from ghc_sim_bridge.ros.display.marks import Marks
from ghc_sim_bridge.scene.description import SceneDescription

TARGET, POINT, OBSTACLE = 0.04, 0.02, 0.05  # [m] diameters
AXIS = 0.1  # [m] of the three lines of an orientation
ENDLESS, SHEET = 4.0, 0.002  # [m] drawn of a plane: width, height
LETTERS = 0.03  # [m]
LOADED = 1.0  # [N] a contact with less is drawn as free
_FAINT = 0.25  # opacity of what is not in force
_AXES = (rgba(PALETTE[4]), rgba(PALETTE[1]), rgba(PALETTE[0]))  # x red, y green, z blue
_FREE = PALETTE[6]


class Scenery:
    """What is drawn beside the robot, from the newest messages."""

    def __init__(
        self, robot: Robot, scene: SceneDescription | None, frame: str, force_scale: float
    ) -> None:
        """`frame`: that of the world; `force_scale` [m/N]."""
        self._model: RobotModel = robot.model
        self._tasks = {task.name: task for task in robot.tasks}
        self._scene, self._force_scale = scene, force_scale
        self._marks = Marks(frame)
        self.sites = contact_sites(robot)

    def message(
        self,
        stamp: Time,
        q: Array,
        report: ControllerState | None,
        forces: Mapping[str, Array],
        obstacles: Sequence[ObstacleState],
    ) -> MarkerArray:
        """Markers at a state q (nq,).

        Args:
            forces: (3,) [N] on the robot, in the axes of the world, by contact.
            obstacles: as measured.
        """
        self._model.update(q, np.zeros(self._model.nv))
        self._marks.begin(stamp)
        self._add_surfaces()
        if report is not None:
            self._add_targets(report)
            self._add_obstacles("virtual obstacles", report.obstacles, PALETTE[5])
        self._add_obstacles("obstacles", obstacles, BOUND)
        contacts = () if report is None else report.contacts
        self._add_contacts(forces, [contact.name for contact in contacts if contact.on])
        return self._marks.message()

    def _add_targets(self, report: ControllerState) -> None:
        names = [task.name for task in report.tasks]
        removed = removed_tasks(names, report.alpha)
        for index, state in enumerate(report.tasks):
            task = self._tasks.get(state.name)
            target = None if task is None else target_of(task, state.reference, self._model)
            if target is not None:
                self._add_target(
                    state.name, target, color(index), _FAINT if removed[state.name] else 1.0
                )

    def _add_target(self, name: str, target: Target, ink: str, opacity: float) -> None:
        marks, shade = self._marks, rgba(ink, opacity)
        if target.quaternion is not None:
            turn = matrix_from_quaternion(target.quaternion)
            ends = [
                end
                for k in range(3)
                for end in (target.position, target.position + AXIS * turn[:, k])
            ]
            marks.lines("target axes", name, ends, 0.006, [(*axis[:3], opacity) for axis in _AXES])
        marks.sphere("targets", name, target.position, TARGET, shade)
        marks.text("names", name, target.position + [0.0, 0.0, TARGET], LETTERS, shade)
        if not target.is_obstacle:
            marks.lines("errors", name, [target.position, target.actual], 0.006, [shade])

    def _add_contacts(self, forces: Mapping[str, Array], on: Sequence[str]) -> None:
        for name, site in self.sites.items():
            points = site_points(site, self._model)
            force = forces.get(name)
            loaded = force is not None and float(np.linalg.norm(force)) > LOADED
            ink = MEASURED if loaded or name in on else _FREE
            for k, point in enumerate(points):
                opacity = 1.0 if loaded or name in on else _FAINT
                self._marks.sphere("contacts", f"{name} {k}", point, POINT, rgba(ink, opacity))
            if force is not None and loaded:
                center = points.mean(axis=0)
                self._marks.arrow(
                    "forces", name, center, center + self._force_scale * force, rgba(MEASURED)
                )

    def _add_obstacles(self, group: str, obstacles: Sequence[ObstacleState], ink: str) -> None:
        for obstacle in obstacles:
            at = np.array(obstacle.position)
            self._marks.sphere(group, obstacle.id, at, OBSTACLE, rgba(ink))
            safe = 2.0 * float(obstacle.safe_distance)
            self._marks.sphere(f"{group}: safe distance", obstacle.id, at, safe, rgba(ink, 0.15))
            self._marks.arrow(
                f"{group}: normal",
                obstacle.id,
                at,
                at + 0.1 * np.array(obstacle.normal),
                rgba(ink),
            )

    def _add_surfaces(self) -> None:
        for surface in () if self._scene is None else self._scene.surfaces:
            flat = (surface.size[0] or ENDLESS, surface.size[1] or ENDLESS)
            size = np.array([*flat, surface.size[2] if surface.kind == "box" else SHEET])
            center = np.asarray(surface.top) - [0.0, 0.0, 0.5 * size[2]]
            self._marks.box("surroundings", surface.name, center, size, surface.colour)
