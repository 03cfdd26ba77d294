"""A robot in the Rerun viewer: the shapes of its URDF, moved by its joint angles."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import rerun as rr

from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array

ROBOT_PATH = "world/robot"


class RerunRobot:
    """Entities world/robot/<joint>: what is fixed to that joint, at its place over time."""

    def __init__(
        self, urdf: Path, joint_names: Sequence[str], floating_base: bool = False
    ) -> None:
        """Load the visual shapes; `joint_names` is the order of the angles given later."""
        root = (pin.JointModelFreeFlyer(),) if floating_base else ()
        self._model = pin.buildModelFromUrdf(str(urdf), *root)
        self._data = self._model.createData()
        self._shapes = pin.buildGeomFromUrdf(
            self._model,
            str(urdf),
            pin.GeometryType.VISUAL,
            package_dirs=list(map(str, urdf.parents)),
        ).geometryObjects
        self.take_order(joint_names)

    def take_order(self, joint_names: Sequence[str]) -> None:
        """Set the order of the angles from now on; InvalidValue for names that are no joints."""
        known = list(self._model.names)[1:]
        wrong = [name for name in joint_names if name not in known]
        if wrong or len(set(joint_names)) != len(joint_names) or not joint_names:
            raise InvalidValue(
                f"joints {', '.join(joint_names) or 'none'} given, each of {', '.join(known)} "
                "at most once expected"
            )
        self._places = [
            self._model.joints[self._model.getJointId(name)].idx_q for name in joint_names
        ]

    def log_shapes(self, recording: rr.RecordingStream) -> None:
        """Log the constant part of the robot."""
        for shape in self._shapes:
            path = f"{self._path(shape.parentJoint)}/{shape.name}"
            recording.log(path, _archetype(shape), static=True)
            if shape.geometry.getObjectType() == pin.hppfcl.OBJECT_TYPE.OT_BVH:
                place = shape.placement
                recording.log(
                    path,
                    rr.Transform3D(
                        translation=place.translation,
                        mat3x3=place.rotation @ np.diag(shape.meshScale),
                    ),
                    static=True,
                )

    def _path(self, joint: int) -> str:
        return ROBOT_PATH if joint == 0 else f"{ROBOT_PATH}/{self._model.names[joint]}"

    def placements(
        self, angles: Array, base: Array | None = None
    ) -> dict[str, tuple[Array, Array]]:
        """Places at `angles` (T, n) [rad]: entity -> ((T, 3) [m], quaternions xyzw (T, 4)).

        `base` (T, 7) is the pose of a floating base: position [m] and quaternion xyzw.
        """
        joints = range(1, self._model.njoints)
        translations = np.empty((len(joints), len(angles), 3))
        quaternions = np.empty((len(joints), len(angles), 4))
        q = pin.neutral(self._model)
        for k, row in enumerate(angles):
            q[self._places] = row
            if base is not None:
                q[:7] = base[k]
            pin.forwardKinematics(self._model, self._data, q)
            for slot, joint in enumerate(joints):
                place = self._data.oMi[joint]
                translations[slot, k] = place.translation
                quaternions[slot, k] = pin.Quaternion(place.rotation).coeffs()
        return {
            self._path(joint): (translations[slot], quaternions[slot])
            for slot, joint in enumerate(joints)
        }


def _archetype(shape: Any) -> Any:
    """The Rerun archetype of one shape of the URDF, with its place."""
    geometry = shape.geometry
    colour = np.round(255 * np.asarray(shape.meshColor)).astype(np.uint8)
    placed = {
        "centers": [shape.placement.translation],
        "quaternions": [pin.Quaternion(shape.placement.rotation).coeffs()],
        "colors": [colour],
        "fill_mode": rr.components.FillMode.Solid,
    }
    if isinstance(geometry, pin.hppfcl.Cylinder):
        return rr.Cylinders3D(
            lengths=[2.0 * geometry.halfLength], radii=[geometry.radius], **placed
        )
    if isinstance(geometry, pin.hppfcl.Sphere):
        return rr.Ellipsoids3D(half_sizes=[[geometry.radius] * 3], **placed)
    if isinstance(geometry, pin.hppfcl.Box):
        return rr.Boxes3D(half_sizes=[geometry.halfSide], **placed)
    return rr.Asset3D(path=shape.meshPath, albedo_factor=colour)
