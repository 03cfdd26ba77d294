"""A run as one Rerun recording (.rrd): arm, targets, alpha, errors, torques on one timeline."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr

from ghc_controller.schema.reader import read_yaml
from ghc_controller.types import Array
from ghc_sim_bridge.logs.controller_series import ControllerSeries
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scene.description import SceneDescription
from ghc_sim_bridge.viewer.layout import (
    ALPHA,
    ERRORS,
    FORCE,
    TIMELINE,
    TORQUE,
    TORQUE_RATE,
    alpha_lines,
    blueprint,
    colours,
    log_lines,
    log_surroundings,
    new_recording,
)
from ghc_sim_bridge.viewer.robot import RerunRobot

POSE_RATE = 50.0  # [Hz] of simulated time, for what moves in 3D
PLOT_RATE = 250.0  # [Hz] of simulated time, for torques and their rates
TARGET_RADIUS = 0.018  # [m]
_POSITION_KINDS = ("frame_position", "frame_pose", "center_of_mass")
_AXES = ["x", "y", "z"]


def position_tasks(robot_file: Path) -> tuple[str, ...]:
    """Tasks of a robot.yaml whose reference begins with a position in the world, x, y and z.

    Raises:
        ConfigurationError: the file cannot be read as such.
    """
    return tuple(
        task.text("name")
        for task in read_yaml(robot_file).sections("tasks")
        if task.text("kind") in _POSITION_KINDS and task.value("axes", _AXES) == _AXES
    )


def write_rerun(
    path: Path,
    log: FullRateLog,
    controller: ControllerSeries,
    scene: SceneDescription,
    robot_file: Path | None = None,
) -> None:
    """Write a run to `path`.

    Args:
        path: file to be written, .rrd; a viewer sees all of it or nothing.
        log: states and torques of every control period.
        controller: alpha, errors and references over the run.
        scene: robot and environment.
        robot_file: robot.yaml that the controller used; that of the scene when not given.

    Raises:
        ConfigurationError: the robot file cannot be used.
    """
    targets = position_tasks(scene.robot_file if robot_file is None else robot_file)
    recording = new_recording()
    plots = [ALPHA, ERRORS, TORQUE, TORQUE_RATE] + ([FORCE] if log.wrenches else [])
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}")
    recording.save(draft, default_blueprint=blueprint(scene.camera, plots))
    log_surroundings(recording, scene)
    _send_robot(recording, log, scene.urdf)
    _send_targets(recording, controller, [name for name in targets if name in controller.tasks])
    _send_controller_plots(recording, controller)
    _send_torque_plots(recording, log)
    for name, wrench in log.wrenches.items():
        _send_forces(recording, name, log, wrench)
    recording.flush()
    recording.disconnect()
    draft.replace(path)


def _times(seconds: Array) -> rr.TimeColumn:
    return rr.TimeColumn(TIMELINE, duration=seconds)


def _send_lines(
    recording: rr.RecordingStream, plot: str, names: Sequence[str], time: Array, values: Array
) -> None:
    """One plot with the columns of `values` (T, len(names)) as lines."""
    log_lines(recording, plot, names)
    columns = rr.Scalars.columns(scalars=values.ravel())
    recording.send_columns(plot, [_times(time)], columns.partition(np.full(len(time), len(names))))


def _send_robot(recording: rr.RecordingStream, log: FullRateLog, urdf: Path) -> None:
    robot = RerunRobot(urdf, log.joint_names, log.base_pose is not None)
    robot.log_shapes(recording)
    stride = max(1, round(1.0 / (POSE_RATE * log.control_dt)))
    time, angles = log.time[::stride], log.q[::stride]
    base = None if log.base_pose is None else log.base_pose[::stride]
    for entity, (translations, quaternions) in robot.placements(angles, base).items():
        recording.send_columns(
            entity,
            [_times(time)],
            rr.Transform3D.columns(translation=translations, quaternion=quaternions),
        )


def _send_targets(
    recording: rr.RecordingStream, controller: ControllerSeries, names: Sequence[str]
) -> None:
    """For each task a ball at the target, the reference path so far, and a line for the error."""
    of_tasks = dict(zip(controller.tasks, colours(len(controller.tasks)), strict=True))
    for name in names:
        colour = of_tasks[name]
        target = controller.references[name][:, :3]
        actual = target - controller.errors[name][:, :3]
        times = [_times(controller.time)]
        entity = f"world/targets/{name}"
        recording.log(
            entity, rr.Points3D.from_fields(colors=[colour], radii=[TARGET_RADIUS]), static=True
        )
        recording.log(
            f"{entity}/error",
            rr.LineStrips3D.from_fields(colors=[colour], radii=[0.004]),
            static=True,
        )
        recording.log(
            f"world/paths/{name}",
            rr.LineStrips3D([actual], colors=[colour], radii=[0.0015]),
            static=True,
        )
        recording.send_columns(entity, times, rr.Points3D.columns(positions=target))
        recording.send_columns(
            f"{entity}/error",
            times,
            rr.LineStrips3D.columns(strips=list(np.stack([target, actual], axis=1))),
        )


def _send_controller_plots(recording: rr.RecordingStream, controller: ControllerSeries) -> None:
    lines = alpha_lines(controller.tasks)
    values = np.stack([controller.alpha[:, i, j] for _, i, j in lines], axis=1)
    _send_lines(recording, ALPHA, [name for name, _, _ in lines], controller.time, values)
    _send_lines(recording, ERRORS, controller.tasks, controller.time, controller.error_norms)


def _send_torque_plots(recording: rr.RecordingStream, log: FullRateLog) -> None:
    stride = max(1, round(1.0 / (PLOT_RATE * log.control_dt)))
    _send_lines(recording, TORQUE, log.joint_names, log.time[::stride], log.torque[::stride])
    rate = np.diff(log.torque, axis=0) / log.control_dt
    rate[np.diff(log.time) <= 0.0] = 0.0  # a reset is no torque step
    _send_lines(
        recording, TORQUE_RATE, log.joint_names, log.time[1::stride], keep_peaks(rate, stride)
    )


def keep_peaks(values: Array, stride: int) -> Array:
    """Of every `stride` rows of `values` (T, n) the entries of largest size, signs kept."""
    rows = -(-len(values) // stride)
    padded = np.zeros((rows * stride, values.shape[1]))
    padded[: len(values)] = values
    windows = padded.reshape(rows, stride, -1)
    largest = np.abs(windows).argmax(axis=1)
    return np.take_along_axis(windows, largest[:, None, :], axis=1)[:, 0]


def _send_forces(
    recording: rr.RecordingStream, name: str, log: FullRateLog, wrench: Array
) -> None:
    stride = max(1, round(1.0 / (PLOT_RATE * log.control_dt)))
    _send_lines(
        recording,
        f"{FORCE}/{name}",
        [f"{name} {axis}" for axis in "xyz"],
        log.time[::stride],
        wrench[::stride, :3],
    )
