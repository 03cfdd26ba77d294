"""MJCF to URDF: bodies, inertias, joints, limits and sites of the compiled model.

MuJoCo's compiler has resolved defaults, classes and inertias from shapes, so that no MJCF is
parsed here. What a URDF cannot represent is left out with a warning: armature, damping, friction,
springs and tendons; joints coupled by an equality become mimic joints.
"""

from __future__ import annotations

import logging
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, tostring

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.mjcf.shapes import add_shapes
from ghc_controller.robot.urdf_frames import (
    inverse,
    numbers,
    placed,
    set_origin,
    turn_about,
    turn_of,
)
from ghc_controller.types import Array

WORLD = "world"
_LOG = logging.getLogger(__name__)
_FREE, _BALL, _SLIDE, _HINGE = range(4)  # mjtJoint
_JOINT_EQUALITY = 2  # mjEQ_JOINT
_JOINT_TRANSMISSION = 0  # mjTRN_JOINT
_NEXT_TO_NONE = "1e-12"  # [kg], [kg m^2]
_LONGEST_SLIDE = 100.0  # [m] either way, of a slide without a range


def urdf_of_mjcf(file: Path, meshes: Path) -> bytes:
    """Text of a URDF with the dynamics of an MJCF file; shapes of meshes are written to `meshes`.

    Raises:
        ConfigurationError: MuJoCo is not installed or rejects the file, a ball joint, or more
            than one body that floats.
    """
    try:
        mujoco = import_module("mujoco")
    except ImportError as error:
        raise ConfigurationError(
            f"{file}: an MJCF, and the Python package 'mujoco' that reads it is not installed: "
            "`pip install mujoco`"
        ) from error
    try:
        model = mujoco.MjModel.from_xml_path(str(file))
    except ValueError as error:
        raise ConfigurationError(
            f"{file}: MuJoCo rejects it: {' '.join(str(error).split())}"
        ) from error
    converter = _Converter(model, file)
    robot = converter.convert()
    add_shapes(robot, model, converter.link_names, meshes)
    return tostring(robot)


class _Converter:
    def __init__(self, model: Any, file: Path) -> None:
        self._model = model
        self._file = file
        self._robot = Element("robot", {"name": file.stem})
        bodies = range(model.nbody)
        self.link_names = [WORLD, *(model.body(k).name or f"body_{k}" for k in bodies[1:])]
        self._torque = _torque_limits(model)
        self._mimics = _mimics(model)

    def convert(self) -> Element:
        """The robot without shapes."""
        model = self._model
        floating = [k for k in range(model.njnt) if model.jnt_type[k] == _FREE]
        if len(floating) > 1:
            names = ", ".join(self.link_names[model.jnt_bodyid[k]] for k in floating)
            raise ConfigurationError(
                f"{self._file}: one free body at most expected, {names} given"
            )
        root = int(model.jnt_bodyid[floating[0]]) if floating else 0
        for body in range(model.nbody):
            if floating and model.body_rootid[body] != root:
                continue  # the world and its fixed bodies
            self._add_link(body)
            if body not in (0, root):
                self._add_joints(body)
        self._add_sites()
        self._warn()
        return self._robot

    def _add_link(self, body: int) -> None:
        model = self._model
        link = SubElement(self._robot, "link", {"name": self.link_names[body]})
        if model.body_mass[body] <= 0.0:
            return
        inertial = SubElement(link, "inertial")
        place = np.eye(4)
        place[:3, 3] = model.body_ipos[body]
        set_origin(inertial, place)
        SubElement(inertial, "mass", {"value": f"{model.body_mass[body]:.17g}"})
        turn = turn_of(model.body_iquat[body])
        full = turn @ np.diag(model.body_inertia[body]) @ turn.T
        entries = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2)}
        entries["iyz"] = (1, 2)
        SubElement(inertial, "inertia", {k: f"{full[at]:.17g}" for k, at in entries.items()})

    def _add_joints(self, body: int) -> None:
        """Parent, then each joint with its own link except the last, then the body's frame."""
        model, name = self._model, self.link_names[body]
        parent, place = (
            self.link_names[model.body_parentid[body]],
            placed(model.body_pos[body], model.body_quat[body]),
        )
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        for k in range(first, first + count):
            anchor = np.eye(4)
            anchor[:3, 3] = model.jnt_pos[k]
            last = k == first + count - 1 and not anchor[:3, 3].any()
            child = name if last else f"{name}_at_{self._joint_name(k)}"
            self._add_joint(k, parent, child, place @ anchor @ self._motion(k))
            if last:
                return
            self._add_intermediate(child)
            parent, place = child, inverse(anchor)
        self._add_fixed(name, parent, name, place)

    def _add_intermediate(self, name: str) -> None:
        """Link between two joints of one body: almost no mass, since MuJoCo rejects zero mass."""
        inertial = SubElement(SubElement(self._robot, "link", {"name": name}), "inertial")
        SubElement(inertial, "mass", {"value": _NEXT_TO_NONE})
        entries = dict.fromkeys(("ixx", "iyy", "izz"), _NEXT_TO_NONE)
        SubElement(inertial, "inertia", entries | dict.fromkeys(("ixy", "ixz", "iyz"), "0"))

    def _motion(self, joint: int) -> Array:
        """(4, 4) from the joint's placement in the file, at its `ref`, to that at zero."""
        axis, ref = self._model.jnt_axis[joint], self._model.qpos0[self._model.jnt_qposadr[joint]]
        motion = np.eye(4)
        if self._model.jnt_type[joint] == _HINGE:
            motion[:3, :3] = turn_about(axis, -ref)
        else:
            motion[:3, 3] = -ref * axis
        return motion

    def _add_joint(self, k: int, parent: str, child: str, place: Array) -> None:
        model, name = self._model, self._joint_name(k)
        if model.jnt_type[k] not in (_HINGE, _SLIDE):
            raise ConfigurationError(
                f"{self._file}: joint '{name}': a hinge or a slide expected, a ball joint or a "
                "free joint below another body given"
            )
        limited = bool(model.jnt_limited[k])
        slide = model.jnt_type[k] == _SLIDE
        kind = "prismatic" if slide else "revolute" if limited else "continuous"
        joint = self._join(name, kind, parent, child, place)
        SubElement(joint, "axis", {"xyz": numbers(model.jnt_axis[k])})
        lower, upper = model.jnt_range[k] if limited else (-_LONGEST_SLIDE, _LONGEST_SLIDE)
        limits = {"lower": f"{lower:.17g}", "upper": f"{upper:.17g}"}
        limits |= {"effort": f"{self._torque[k]:.17g}", "velocity": "0"}
        SubElement(joint, "limit", limits)
        if k in self._mimics:
            leader, factor, offset = self._mimics[k]
            given = {"multiplier": f"{factor:.17g}", "offset": f"{offset:.17g}"}
            SubElement(joint, "mimic", {"joint": self._joint_name(leader), **given})

    def _add_fixed(self, name: str, parent: str, child: str, place: Array) -> None:
        self._join(f"{name}_fixed", "fixed", parent, child, place)

    def _join(self, name: str, kind: str, parent: str, child: str, place: Array) -> Element:
        joint = SubElement(self._robot, "joint", {"name": name, "type": kind})
        set_origin(joint, place)
        SubElement(joint, "parent", {"link": parent})
        SubElement(joint, "child", {"link": child})
        return joint

    def _add_sites(self) -> None:
        """Named sites become frames, since they usually name tools and feet."""
        links = {link.get("name", "") for link in self._robot.iterfind("link")}
        for site in range(self._model.nsite):
            name, link = (
                self._model.site(site).name,
                self.link_names[self._model.site_bodyid[site]],
            )
            if name and name not in links and link in links:
                SubElement(self._robot, "link", {"name": name})
                place = placed(self._model.site_pos[site], self._model.site_quat[site])
                self._add_fixed(name, link, name, place)

    def _joint_name(self, joint: int) -> str:
        return self._model.joint(joint).name or f"joint_{joint}"

    def _warn(self) -> None:
        model = self._model
        left = {
            "armature": model.dof_armature.any(),
            "damping": model.dof_damping.any(),
            "joint friction": model.dof_frictionloss.any(),
            "springs": model.jnt_stiffness.any(),
            "tendons": model.ntendon > 0,
            "gravity compensation": model.body_gravcomp.any(),
        }
        names = ", ".join(name for name, there in left.items() if there)
        if names:
            _LOG.warning(
                "%s: left out, since a URDF cannot represent it: %s", self._file.name, names
            )


def _torque_limits(model: Any) -> Array:
    """(joints,) [Nm] or [N] of the motors at each joint; 0 where the file has none."""
    limits = np.zeros(model.njnt)
    for k in range(model.nu):
        if model.actuator_trntype[k] != _JOINT_TRANSMISSION:
            continue
        joint, gear = model.actuator_trnid[k, 0], abs(model.actuator_gear[k, 0])
        motor = model.actuator_gaintype[k] == 0 and model.actuator_biastype[k] == 0
        if model.actuator_forcelimited[k]:
            limits[joint] += gear * np.abs(model.actuator_forcerange[k]).min()
        elif motor and model.actuator_ctrllimited[k]:
            gain = abs(model.actuator_gainprm[k, 0])
            limits[joint] += gear * gain * np.abs(model.actuator_ctrlrange[k]).min()
    for k in range(model.njnt):
        if model.jnt_actfrclimited[k]:
            most = float(np.abs(model.jnt_actfrcrange[k]).min())
            limits[k] = min(limits[k], most) if limits[k] > 0.0 else most
    return limits


def _mimics(model: Any) -> dict[int, tuple[int, float, float]]:
    """Joint -> the joint that it follows, factor and offset, of equalities between joints.

    MuJoCo counts both from where they are in the file: q - q_0 = a_0 + a_1 (p - p_0).
    """
    found, start = {}, model.qpos0[model.jnt_qposadr]
    for k in range(model.neq):
        follower, leader = int(model.eq_obj1id[k]), int(model.eq_obj2id[k])
        if model.eq_type[k] == _JOINT_EQUALITY and leader >= 0 and model.eq_active0[k]:
            factor = float(model.eq_data[k, 1])
            offset = float(model.eq_data[k, 0] + start[follower] - factor * start[leader])
            found[follower] = (leader, factor, offset)
    return found
