"""A running robot in the Rerun viewer: entities as in a recording, one instant per call."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from ghc_controller.errors import InvalidValue
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
    """Logs states and reports as they arrive; the caller decides how often."""

    def __init__(
        self, recording: rr.RecordingStream, scene: SceneDescription, targets: Sequence[str]
    ) -> None:
        """`targets` are the tasks whose reference begins with a position in the world."""
        self._recording = recording
        self._scene = scene
        self._targets = tuple(targets)
        self._robot: RerunRobot | None = None
        self._names: tuple[str, ...] = ()
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

        Raises:
            InvalidValue: sizes that do not fit, unknown joints, positions that are not finite.
        """
        recording = self._recording
        if not len(names) == len(q) == len(torque) or not np.isfinite(q).all():
            raise InvalidValue(
                f"{len(names)} names, {len(q)} positions and {len(torque)} efforts given, one "
                "finite position and one effort per name expected"
            )
        if tuple(names) != self._names:
            self._begin(tuple(names), base is not None)
        assert self._robot is not None
        pose = None if base is None else base[None]
        recording.set_time(TIMELINE, duration=time)
        for entity, (translation, quaternion) in self._robot.placements(q[None], pose).items():
            recording.log(
                entity, rr.Transform3D(translation=translation[0], quaternion=quaternion[0])
            )
        recording.log(TORQUE, rr.Scalars(torque))
        if self._last is not None and time > self._last[0] and len(torque) == len(self._last[1]):
            rate = (torque - self._last[1]) / (time - self._last[0])
            recording.log(TORQUE_RATE, rr.Scalars(rate))
        self._last = (time, torque)

    def _begin(self, names: tuple[str, ...], floating_base: bool) -> None:
        """Set the order of the joints from now on; the first call creates the robot."""
        if self._robot is None:
            robot = RerunRobot(self._scene.urdf, names, floating_base)
            robot.log_shapes(self._recording)
            self._robot = robot
        self._robot.take_order(names)
        self._names = names
        log_lines(self._recording, TORQUE, names)
        log_lines(self._recording, TORQUE_RATE, names)

    def show_report(self, time: float, report: Any) -> None:
        """Log the status of the controller (ControllerState) at the state of `time` [s].

        Raises:
            InvalidValue: alpha is no matrix of the tasks.
        """
        recording = self._recording
        tasks = tuple(task.name for task in report.tasks)
        if len(report.alpha) != len(tasks) ** 2:
            raise InvalidValue(
                f"alpha of {len(report.alpha)} entries given, {len(tasks) ** 2} expected for "
                f"{len(tasks)} tasks"
            )
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
            if task.name in self._targets and min(len(task.reference), len(task.error)) >= 3:
                self._show_target(task, colour)

    def _show_target(self, task: Any, colour: NDArray[np.uint8]) -> None:
        target = np.array(task.reference[:3])
        actual = target - np.array(task.error[:3])
        entity = f"world/targets/{task.name}"
        self._recording.log(entity, rr.Points3D([target], colors=[colour], radii=[TARGET_RADIUS]))
        self._recording.log(
            f"{entity}/error", rr.LineStrips3D([[target, actual]], colors=[colour], radii=[0.004])
        )
