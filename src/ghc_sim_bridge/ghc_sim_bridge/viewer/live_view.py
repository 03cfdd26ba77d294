"""A running robot in the Rerun viewer: the same entities as in a recording, one instant a call."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from ghc_controller.types import Array
from ghc_sim_bridge.scene.description import SceneDescription
from ghc_sim_bridge.viewer.layout import (
    ALPHA,
    ERRORS,
    TIMELINE,
    TORQUE,
    TORQUE_RATE,
    alpha_lines,
    blueprint,
    colours,
    log_lines,
    log_surroundings,
)
from ghc_sim_bridge.viewer.robot import RerunRobot

TARGET_RADIUS = 0.018  # [m]


class LiveView:
    """Sends states and reports as they come; whoever calls decides how often."""

    def __init__(
        self, recording: rr.RecordingStream, scene: SceneDescription, targets: Sequence[str]
    ) -> None:
        """`targets` are the tasks whose reference begins with a position in the world."""
        self._recording = recording
        self._scene = scene
        self._targets = tuple(targets)
        self._robot: RerunRobot | None = None
        self._tasks: tuple[str, ...] = ()
        self._last: tuple[float, Array] | None = None  # [s], (n,) [Nm]
        recording.send_blueprint(blueprint(scene.camera, [ALPHA, ERRORS, TORQUE, TORQUE_RATE]))
        log_surroundings(recording, scene)

    def show_state(
        self,
        time: float,
        names: Sequence[str],
        q: Array,
        torque: Array,
        base: Array | None = None,
    ) -> None:
        """State at `time` [s]: q (n,) [rad] and torque (n,) [Nm] of the joints `names`, and the
        pose (7,) of a floating base: position [m] and quaternion xyzw.

        The torque rate is the mean since the state shown before, not that of a single period.
        """
        recording = self._recording
        if self._robot is None:
            self._robot = RerunRobot(self._scene.urdf, names, base is not None)
            self._robot.log_shapes(recording)
            log_lines(recording, TORQUE, names)
            log_lines(recording, TORQUE_RATE, names)
        pose = None if base is None else base[None]
        recording.set_time(TIMELINE, duration=time)
        for entity, (translation, quaternion) in self._robot.placements(q[None], pose).items():
            recording.log(
                entity, rr.Transform3D(translation=translation[0], quaternion=quaternion[0])
            )
        recording.log(TORQUE, rr.Scalars(torque))
        if self._last is not None and time > self._last[0]:
            rate = (torque - self._last[1]) / (time - self._last[0])
            recording.log(TORQUE_RATE, rr.Scalars(rate))
        self._last = (time, torque)

    def show_report(self, time: float, report: Any) -> None:
        """What the controller reported (ControllerState) of the state at `time` [s]."""
        recording = self._recording
        tasks = tuple(task.name for task in report.tasks)
        lines = alpha_lines(tasks)
        if tasks != self._tasks:
            self._tasks = tasks
            log_lines(recording, ALPHA, [name for name, _, _ in lines])
            log_lines(recording, ERRORS, tasks)
        recording.set_time(TIMELINE, duration=time)
        alpha = np.array(report.alpha).reshape(len(tasks), -1)
        recording.log(ALPHA, rr.Scalars([alpha[i, j] for _, i, j in lines]))
        recording.log(ERRORS, rr.Scalars([task.error_norm for task in report.tasks]))
        for task, colour in zip(report.tasks, colours(len(tasks)), strict=True):
            if task.name in self._targets and len(task.reference) >= 3:
                self._show_target(task, colour)

    def _show_target(self, task: Any, colour: NDArray[np.uint8]) -> None:
        target = np.array(task.reference[:3])
        actual = target - np.array(task.error[:3])
        entity = f"world/targets/{task.name}"
        self._recording.log(entity, rr.Points3D([target], colors=[colour], radii=[TARGET_RADIUS]))
        self._recording.log(
            f"{entity}/error", rr.LineStrips3D([[target, actual]], colors=[colour], radii=[0.004])
        )
