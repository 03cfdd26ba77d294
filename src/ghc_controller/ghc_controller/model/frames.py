"""Kinematics of every frame in use, computed by one compiled call after the dynamics."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ghc_controller.model.joint_memory import stacked_view
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class FrameTerms:
    """Kinematics of one frame; views that stay current with RobotModel.update.

    Velocity, drift and Jacobian belong to the frame's origin, in world axes, linear part first
    (Pinocchio's LOCAL_WORLD_ALIGNED): velocity = J v, acceleration = J dv + drift.
    """

    position: Array  # (3,) origin in the world [m]
    rotation: Array  # (3, 3) frame to world
    jacobian: Array  # (6, n)
    velocity: Array  # (6,) [m/s], [rad/s]
    drift: Array  # (6,) dJ/dt v: classical acceleration at dv = 0 [m/s^2], [rad/s^2]


class FrameTable:
    """Registered frames with one row each in contiguous arrays.

    Reads the joint placements, velocities, accelerations and Jacobian columns that
    `pin.crba(WORLD)` and `pin.nonLinearEffects` leave in pin.Data, so that a frame costs no
    further Pinocchio call.
    """

    def __init__(self, model: pin.Model, data: pin.Data) -> None:
        self._model = model
        joints = range(model.njoints)
        # SE3 in memory: rotation column by column, then translation. Motion: linear, angular.
        self._placement = stacked_view([data.oMi[i].rotation for i in joints], 12)
        self._velocity = stacked_view([data.v[i].vector for i in joints], 6)
        self._acceleration = stacked_view([data.a_gf[i].vector for i in joints], 6)
        # A matrix of one column comes out of Pinocchio as a vector.
        self._joint_jacobian = data.J.reshape((6, model.nv), order="F")
        self._gravity = np.array(model.gravity.linear)
        self._slots: dict[int, int] = {}
        self._parents = np.zeros(0, dtype=np.int64)
        self._offsets = np.zeros((0, 12))
        self._support = np.zeros((0, model.nv), dtype=np.bool_)
        self._allocate()

    def register(self, pin_frame: int) -> int:
        """Row of a Pinocchio frame index; adds it on first use (values current after compute)."""
        if pin_frame not in self._slots:
            frame = self._model.frames[pin_frame]
            offset = np.concatenate(
                [frame.placement.rotation.ravel(order="F"), frame.placement.translation]
            )
            support = np.zeros((1, self._model.nv), dtype=np.bool_)
            for joint in self._model.supports[frame.parentJoint]:
                if joint > 0:
                    first = self._model.joints[joint].idx_v
                    support[0, first : first + self._model.joints[joint].nv] = True
            self._parents = np.append(self._parents, frame.parentJoint)
            self._offsets = np.vstack([self._offsets, offset])
            self._support = np.vstack([self._support, support])
            self._slots[pin_frame] = len(self._slots)
            self._allocate()
        return self._slots[pin_frame]

    def compute(self) -> None:
        """Refresh every registered frame from the joint values now in pin.Data."""
        if self.terms:
            frame_kinematics(
                self._placement,
                self._velocity,
                self._acceleration,
                self._joint_jacobian,
                self._gravity,
                self._parents,
                self._offsets,
                self._support,
                self._poses,
                self._jacobians,
                self._motions,
            )

    def _allocate(self) -> None:
        count = len(self._slots)
        self._poses = np.zeros((count, 4, 3))  # rows 0-2: rotation, row 3: position
        self._jacobians = np.zeros((count, 6, self._model.nv))
        self._motions = np.zeros((count, 2, 6))  # velocity, drift
        self.terms = [
            FrameTerms(pose[3], pose[:3], jacobian, motion[0], motion[1])
            for pose, jacobian, motion in zip(
                self._poses, self._jacobians, self._motions, strict=True
            )
        ]


@numba.njit(cache=True)
def frame_kinematics(
    placement: Array,
    joint_velocity: Array,
    joint_acceleration: Array,
    joint_jacobian: Array,
    gravity: Array,
    parents: NDArray[np.int64],
    offsets: Array,
    support: NDArray[np.bool_],
    poses: Array,
    jacobians: Array,
    motions: Array,
) -> None:
    """Pose, Jacobian, velocity and drift of each frame from its parent joint.

    With R, p the parent's placement, (l, w) its velocity and (a, b) its acceleration at dv = 0 in
    joint axes, r the frame's origin in the joint, u = l + w x r:
    velocity = R (u, w), drift = R (a + b x r + w x u, b) + (gravity, 0), since Pinocchio's a_gf
    carries minus gravity; Jacobian column j = (J_lin + J_ang x position, J_ang) of joint_jacobian,
    whose linear part belongs to the point at the world's origin.
    """
    point = np.empty(3)
    linear = np.empty(3)
    bias = np.empty(3)
    for f in range(parents.shape[0]):
        joint = parents[f]
        r0, r1, r2 = offsets[f, 9], offsets[f, 10], offsets[f, 11]
        vel, acc = joint_velocity[joint], joint_acceleration[joint]
        linear[0] = vel[0] + vel[4] * r2 - vel[5] * r1
        linear[1] = vel[1] + vel[5] * r0 - vel[3] * r2
        linear[2] = vel[2] + vel[3] * r1 - vel[4] * r0
        bias[0] = acc[0] + acc[4] * r2 - acc[5] * r1 + vel[4] * linear[2] - vel[5] * linear[1]
        bias[1] = acc[1] + acc[5] * r0 - acc[3] * r2 + vel[5] * linear[0] - vel[3] * linear[2]
        bias[2] = acc[2] + acc[3] * r1 - acc[4] * r0 + vel[3] * linear[1] - vel[4] * linear[0]
        for i in range(3):
            x, y, z = placement[joint, i], placement[joint, 3 + i], placement[joint, 6 + i]
            for j in range(3):
                poses[f, i, j] = (
                    x * offsets[f, 3 * j] + y * offsets[f, 3 * j + 1] + z * offsets[f, 3 * j + 2]
                )
            point[i] = placement[joint, 9 + i] + x * r0 + y * r1 + z * r2
            poses[f, 3, i] = point[i]
            motions[f, 0, i] = x * linear[0] + y * linear[1] + z * linear[2]
            motions[f, 0, 3 + i] = x * vel[3] + y * vel[4] + z * vel[5]
            motions[f, 1, i] = gravity[i] + x * bias[0] + y * bias[1] + z * bias[2]
            motions[f, 1, 3 + i] = x * acc[3] + y * acc[4] + z * acc[5]
        for j in range(support.shape[1]):
            if support[f, j]:
                wx, wy, wz = joint_jacobian[3, j], joint_jacobian[4, j], joint_jacobian[5, j]
                jacobians[f, 0, j] = joint_jacobian[0, j] + wy * point[2] - wz * point[1]
                jacobians[f, 1, j] = joint_jacobian[1, j] + wz * point[0] - wx * point[2]
                jacobians[f, 2, j] = joint_jacobian[2, j] + wx * point[1] - wy * point[0]
                jacobians[f, 3, j] = wx
                jacobians[f, 4, j] = wy
                jacobians[f, 5, j] = wz
