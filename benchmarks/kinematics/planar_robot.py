"""The planar robot of the paper: a slider, a link, and two arms on its end; all lengths 1 m."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ghc_controller.kinematics import Level
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.frame import FramePositionTask
from ghc_controller.types import Array

START = np.array([0.0, np.pi / 2, 0.0, 0.0])  # [m], [rad] links point to -x: docs/gn_qn.md

_INERTIA = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
_LIMIT = '<limit lower="-1e6" upper="1e6" velocity="1e6" effort="1e6"/>'


def _link(name: str) -> str:
    return f'<link name="{name}">{_INERTIA}</link>'


def _joint(name: str, kind: str, parent: str, child: str, height: int, axis: str) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0 0 {height}"/><axis xyz="{axis}"/>{_LIMIT}</joint>'
    )


def planar_robot() -> RobotModel:
    """q = [slider x, th1, th2, th3], zero with all links along +z, angles from +z to -x."""
    turn = "0 -1 0"
    parts = [
        *(_link(n) for n in ("base", "slider", "trunk", "arm2", "arm3", "ef1", "ef2", "ef3")),
        _joint("s", "prismatic", "base", "slider", 0, "1 0 0"),
        _joint("th1", "revolute", "slider", "trunk", 0, turn),
        _joint("th2", "revolute", "trunk", "arm2", 1, turn),
        _joint("th3", "revolute", "trunk", "arm3", 1, turn),
        _joint("j1", "fixed", "trunk", "ef1", 1, turn),
        _joint("j2", "fixed", "arm2", "ef2", 1, turn),
        _joint("j3", "fixed", "arm3", "ef3", 1, turn),
    ]
    return RobotModel(pin.buildModelFromXML(f'<robot name="planar">{"".join(parts)}</robot>'))


def planar_levels(model: RobotModel, shoulder_box: bool) -> list[Level]:
    """Hierarchy A: ef2 (blue) above ef3 (green); B: the shoulder's box above both."""
    task = {
        name: FramePositionTask(name, model, name, 1.0, 1.0, axes=("x", "z"))
        for name in ("ef1", "ef2", "ef3")
    }
    box = [Level(task["ef1"], bounded=True)] if shoulder_box else []
    return [*box, Level(task["ef2"]), Level(task["ef3"])]


SHOULDER_BOX: tuple[Array, Array] = (np.array([-1.0, 0.0]), np.array([1.0, 1.0]))  # [m]
