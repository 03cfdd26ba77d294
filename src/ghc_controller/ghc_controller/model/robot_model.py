"""Kinematics and dynamics of the robot: read by Pinocchio, computed by the compiled core."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from pathlib import Path

import numpy as np
import pinocchio as pin

from ghc_controller.errors import ConfigurationError, UnknownName, WrongSize
from ghc_controller.model.frames import FrameTerms
from ghc_controller.model.limits import JointLimits
from ghc_controller.model.rounded_shape import Shape
from ghc_controller.model.structure import (
    actuated_joints,
    has_floating_base,
    joint_order,
    model_limits,
    read_urdf,
)
from ghc_controller.model.tree import add_frame, make_core
from ghc_controller.types import Array, Dynamics

CollisionShapes = Callable[[Collection[str]], Mapping[str, tuple[Shape, ...]]]

_LEAST_INERTIA = 1e-12  # [kg m^2] or [kg] on the diagonal of M


def _no_shapes(_names: Collection[str]) -> Mapping[str, tuple[Shape, ...]]:
    return {}


class RobotModel:
    """A robot whose `update` makes every query below current for one state.

    Coordinates are Pinocchio's: with a floating base q starts with position and quaternion
    x, y, z, w of the base, v with its linear and angular velocity in base axes. Queries return
    views that the next `update` overwrites: copy what must outlive the tick.

    Attributes:
        joint_names: actuated joints, in the order of the last `na` entries of q and v.
        nq, nv, na: sizes of q, v and torque; n = nv in shapes.
        limits: JointLimits; also as position_lower, position_upper, velocity_limit, torque_limit.
        dynamics: Dynamics of the last update; with the contact forces told to `exert` since.
        q, v: state of the last update, (nq,) and (n,).
        collision_shapes: (names of links) -> their shapes in the URDF; none without a file.
        joint_of: (n,) number of the joint that each velocity coordinate belongs to.
        carries: (n, n), [a, b] is True where the joint of a is the joint of b or carries it.
        exerted: what was told to `exert` since the last update, by name; always the same object.
    """

    def __init__(self, model: pin.Model, limits: JointLimits | None = None) -> None:
        """Take over a pin.Model with one-coordinate joints behind an optional free flyer.

        Raises:
            ConfigurationError: no actuated joint, or a joint of several coordinates (among them
                URDF `continuous` joints, whose angle Pinocchio stores as cosine and sine).
        """
        self._model = model
        self.collision_shapes: CollisionShapes = _no_shapes
        self.floating_base = has_floating_base(model)
        self.joint_names = actuated_joints(model)
        self.nq: int = model.nq
        self.nv: int = model.nv
        self.na: int = len(self.joint_names)
        self.limits = limits or model_limits(model, self.na)
        self.core = core = make_core(model)
        self.q, self.v = core.q, core.v
        self.mass = core.mass  # [kg]
        self.weight = self.mass * float(np.linalg.norm(model.gravity.linear))  # [N]
        self._center, self._center_jacobian = core.center, core.center_jacobian
        self._gravity_torque = core.gravity_torque
        self._frame_names = tuple(f.name for f in model.frames if f.type == pin.FrameType.BODY)
        self._frame_ids: dict[str, int] = {}
        self._frames: list[FrameTerms] = []
        self.joint_of, self.carries = joint_order(model)
        self.exerted: dict[str, Array] = {}  # name -> (n,) J^T force [Nm]
        self.dynamics = self._free_dynamics = Dynamics(core.mass_matrix, core.bias)
        self.update(pin.neutral(model), np.zeros(self.nv))
        moved = np.diag(self.dynamics.mass_matrix)[self.nv - self.na :]
        for name, inertia in zip(self.joint_names, moved, strict=True):
            if not inertia > _LEAST_INERTIA:
                raise ConfigurationError(
                    f"joint '{name}' moves no mass: its links need an <inertial> with mass and "
                    "inertia"
                )

    @classmethod
    def from_urdf(
        cls, path: str | Path, floating_base: bool = False, limits: JointLimits | None = None
    ) -> RobotModel:
        """Load a URDF; `limits` replaces those of the file.

        Raises:
            ConfigurationError: the file does not exist, is no URDF, or has an unsupported joint.
        """
        path = Path(path)
        model = read_urdf(path, floating_base)
        try:
            return cls(model, limits)
        except ConfigurationError as error:
            raise ConfigurationError(f"{path}: {error}") from error

    def copy(self) -> RobotModel:
        """A model with the same limits and handles of frames, and with a state of its own."""
        copied = RobotModel(self._model, self.limits.copy())
        copied.collision_shapes = self.collision_shapes
        for name in self._frame_ids:  # in the order in which their numbers were given
            copied.frame_id(name)
        return copied

    def update(self, q: Array, v: Array) -> Dynamics:
        """Compute dynamics and all frames in use at state q (nq,), v (n,).

        Returns:
            `self.dynamics`, which the next update overwrites.

        Raises:
            WrongSize: q or v has another shape.
        """
        if q.shape != (self.nq,):
            raise WrongSize("q", q.shape, (self.nq,))
        if v.shape != (self.nv,):
            raise WrongSize("v", v.shape, (self.nv,))
        self.core.update(q, v)
        if self.exerted:
            self.exerted.clear()
            self.dynamics = self._free_dynamics
        return self.dynamics

    def exert(self, name: str, jacobian: Array, force: Array) -> None:
        """Account for a force on the surroundings in `self.dynamics` until the next update.

        In eq. 1, M dv + h = S^T tau + Jc^T w_c, the contact wrench w_c = -force is known and moves
        to the left: `dynamics.bias` becomes h + J^T force. Torque from inverse dynamics then
        carries the force, and dv stays the acceleration that the robot really gets in contact.
        The Dynamics that `update` returned are not changed.

        Args:
            name: who exerts it, such as a task; a second call of the same name replaces the first.
            jacobian: (r, n) of the points and directions of the force.
            force: (r,) [N] or [Nm] of the robot on its surroundings.
        """
        self.exerted[name] = force @ jacobian
        free = self._free_dynamics
        self.dynamics = Dynamics(free.mass_matrix, sum(self.exerted.values(), free.bias))

    @property
    def frame_names(self) -> tuple[str, ...]:
        """Names of the links, each with a frame."""
        return self._frame_names

    def chain(self, name: str) -> frozenset[int]:
        """Numbers of the joints that move a link, as in `joint_of`.

        Raises:
            UnknownName: no link of that name.
        """
        if name not in self._frame_names:
            raise UnknownName("frame", name, self._frame_names)
        frame = self._model.frames[self._model.getFrameId(name, pin.FrameType.BODY)]
        return frozenset(int(one) for one in self._model.supports[frame.parentJoint]) - {0}

    def frame_id(self, name: str) -> int:
        """Handle for the frame queries; a frame takes part in `update` from its first call on.

        Raises:
            UnknownName: no link of that name; lists those that exist.
        """
        if name not in self._frame_ids:
            if name not in self._frame_names:
                raise UnknownName("frame", name, self._frame_names)
            pin_frame = self._model.getFrameId(name, pin.FrameType.BODY)
            number = add_frame(self.core, self._model, pin_frame)
            self.core.update_frames()
            self._frames.append(FrameTerms.of(self.core.frame(number)))
            self._frame_ids[name] = number
        return self._frame_ids[name]

    def frame(self, frame_id: int) -> FrameTerms:
        """All terms of a frame in one call: the cheapest query."""
        return self._frames[frame_id]

    def frame_position(self, frame_id: int) -> Array:
        """Origin of the frame in the world, (3,) [m]."""
        return self._frames[frame_id].position

    def frame_rotation(self, frame_id: int) -> Array:
        """Rotation from frame to world, (3, 3)."""
        return self._frames[frame_id].rotation

    def frame_jacobian(self, frame_id: int) -> Array:
        """Jacobian of the origin's motion in world axes, linear rows first, (6, n)."""
        return self._frames[frame_id].jacobian

    def frame_velocity(self, frame_id: int) -> Array:
        """J v, (6,) [m/s], [rad/s] in world axes."""
        return self._frames[frame_id].velocity

    def frame_drift(self, frame_id: int) -> Array:
        """dJ/dt v, (6,) [m/s^2], [rad/s^2] in world axes (second term of eq. 2)."""
        return self._frames[frame_id].drift

    def gravity(self) -> Array:
        """Torque that holds the robot still, the bias at v = 0: (n,) [Nm] or [N]."""
        return self._gravity_torque

    def integrate(self, q: Array, step: Array) -> Array:
        """Configuration (nq,) after moving q by a step in velocity coordinates, (n,)."""
        return np.asarray(pin.integrate(self._model, q, step))

    def angular_axes(self) -> Array:
        """(3, n) angular velocity in world axes per velocity coordinate; 0 for translations."""
        axes = np.empty((3, self.nv))
        self.core.axes(axes)
        return axes

    def center_of_mass(self) -> Array:
        """Centre of mass in the world, (3,) [m]."""
        return self._center[0]

    def center_of_mass_velocity(self) -> Array:
        """(3,) [m/s]."""
        return self._center[1]

    def center_of_mass_jacobian(self) -> Array:
        """(3, n) linear rows of the momentum matrix over the mass."""
        return self._center_jacobian

    def center_of_mass_drift(self) -> Array:
        """dJ/dt v, (3,) [m/s^2]."""
        return self._center[2]

    # Shorthands of `limits`, each (na,).
    @property
    def position_lower(self) -> Array:
        """[rad] or [m]."""
        return self.limits.position_lower

    @property
    def position_upper(self) -> Array:
        """[rad] or [m]."""
        return self.limits.position_upper

    @property
    def velocity_limit(self) -> Array:
        """Magnitude [rad/s] or [m/s]."""
        return self.limits.velocity

    @property
    def torque_limit(self) -> Array:
        """Magnitude [Nm] or [N]."""
        return self.limits.torque

    def joint_index(self, name: str) -> int:
        """Place of an actuated joint in `joint_names`.

        Raises:
            UnknownName: lists the joints that exist.
        """
        if name not in self.joint_names:
            raise UnknownName("joint", name, self.joint_names)
        return self.joint_names.index(name)
