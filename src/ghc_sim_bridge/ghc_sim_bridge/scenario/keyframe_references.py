"""Computes task references from postures by forward kinematics.

The robot stands on the frames listed in its scene (`base.stand_on`): they stay fixed, and the base
motion follows from the joints. Fixed-base robots need no such frames.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import Robot, load_robot_config
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array
from ghc_sim_bridge.scenario.keyframes import JointMotion, Keyframes, joint_motion
from ghc_sim_bridge.scenario.posture_motion import configuration
from ghc_sim_bridge.scenario.references import Reference, ReferencePoint
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.scene.values import SceneDescription

_BASE = 6  # velocity coordinates of a floating base
_SLIP = 1e-3  # [m] largest motion of the other frames of `stand_on` relative to the first one


def keyframe_references(keyframes: Keyframes, robot: str, scene: str) -> tuple[Reference, ...]:
    """References of `keyframes.tasks` with velocities and accelerations, posture by posture.

    Raises:
        UnknownName: a task or joint that the robot does not have.
        ConfigurationError: robot or scene is invalid, or the frames that it stands on would move
            relative to each other.
    """
    config = load_robot_config(find_robot(robot))
    description = load_scene(scene)
    for name in keyframes.tasks:
        if name not in config.task_names:
            raise UnknownName("task in keyframes", name, config.task_names)
    for keyframe in keyframes.postures:
        for name in keyframe.joints:
            config.model.joint_index(name)
    tasks = [config.tasks[config.task_names.index(name)] for name in keyframes.tasks]
    start = np.array([description.start.get(name, 0.0) for name in config.model.joint_names])
    points: dict[str, list[ReferencePoint]] = {task.name: [] for task in tasks}
    footing: list[Array] = []
    for time in keyframes.sample_times():
        motion = joint_motion(keyframes, start, config.model.joint_names, time)
        q, v, a, stand = _whole_motion(config, description, motion)
        footing.append(stand)
        _check_footing(footing, description, time)
        config.model.update(q, v)
        for task in tasks:
            points[task.name].append(_point(task, config.model, time, v, a))
    return tuple(
        Reference(task.name, tuple(points[task.name]), _joints_of(task)) for task in tasks
    )


def _joints_of(task: Task) -> tuple[str, ...]:
    return task.labels if task.error_unit == "rad" and task.position_size == task.size else ()


def _point(task: Task, model: RobotModel, time: float, v: Array, a: Array) -> ReferencePoint:
    """Task variable at the last update, J v, and J a + dJ/dt v."""
    position = task.current(model).copy()
    rows = task.measured(model, task.static_target(position))
    velocity = task.as_reference(model, rows.jacobian @ v)
    acceleration = task.as_reference(model, rows.jacobian @ a + rows.drift)
    return ReferencePoint(time, tuple(position), tuple(velocity), tuple(acceleration))


def _whole_motion(
    config: Robot, scene: SceneDescription, joints: JointMotion
) -> tuple[Array, Array, Array, Array]:
    """q (nq,), v (nv,), a (nv,), and origins (frames, 3) [m] of the frames that it stands on,
    relative to the first one."""
    if scene.base is None:
        return joints.position, joints.velocity, joints.acceleration, np.zeros((0, 3))
    model = config.model
    q = configuration(model, scene.base, joints.position)
    frames = [model.frame_id(name) for name in scene.base.stand_on]
    first = frames[0]
    turn, origin = model.frame_rotation(first).T, model.frame_position(first)
    seen = np.array([turn @ (model.frame_position(frame) - origin) for frame in frames])
    jacobian = model.frame_jacobian(first).copy()
    on_base, on_joints = jacobian[:, :_BASE], jacobian[:, _BASE:]
    v = np.concatenate([-np.linalg.solve(on_base, on_joints @ joints.velocity), joints.velocity])
    model.update(q, v)
    change = on_joints @ joints.acceleration + model.frame_drift(first)
    a = np.concatenate([-np.linalg.solve(on_base, change), joints.acceleration])
    return q, v, a, seen


def _check_footing(footing: Sequence[Array], scene: SceneDescription, time: float) -> None:
    if scene.base is None:
        return
    moved = np.linalg.norm(footing[-1] - footing[0], axis=1)
    worst = int(np.argmax(moved))
    if moved[worst] > _SLIP:
        raise ConfigurationError(
            f"keyframes at {time:g} s: {scene.base.stand_on[worst]} would move by "
            f"{1e3 * moved[worst]:.1f} mm against {scene.base.stand_on[0]}; postures that leave "
            "both where they are expected"
        )
