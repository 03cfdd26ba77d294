"""The simulated robot: apply a torque, step, read the state. MuJoCo inside, no ROS.

Everything is in the coordinates of the robot model (see coordinates.py), joints in the order of
`joint_names`; MuJoCo's stay inside. Shapes: na joints, nq and nv with the base if that floats.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName, WrongSize
from ghc_controller.model.limits import overridden
from ghc_controller.safety.braking import braking_torque
from ghc_controller.types import CONTROL_DT, Array, Dynamics, RobotState
from ghc_sim_bridge.errors import SimulationDiverged
from ghc_sim_bridge.scene.description import SceneDescription, load_scene
from ghc_sim_bridge.simulation.base_start import base_pose
from ghc_sim_bridge.simulation.contact_sensors import ContactSensors
from ghc_sim_bridge.simulation.coordinates import FixedBase, FloatingBase
from ghc_sim_bridge.simulation.disturbances import Disturbances
from ghc_sim_bridge.simulation.joint_map import JointMap
from ghc_sim_bridge.simulation.mujoco_model import base_frame_of, build_model, joints_of
from ghc_sim_bridge.simulation.standing_hold import standing_torque
from ghc_sim_bridge.simulation.timing import PHYSICS_DT, count_substeps

LARGEST_SPEED = 1e3  # [rad/s] beyond it a state is diverged, not fast
LARGEST_TORQUE = 1e6  # [Nm] beyond it a torque is a mistake, not a command
_BASE_AT_ORIGIN = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])  # position, quaternion xyzw

_BEYOND = 0.1  # [rad] or [m] beyond a limit that a start may be, as a seated robot is


class Simulator:
    """One robot in its scene, moved by joint torques.

    A step runs from the state at t_k under a torque that is held until t_k+1. Afterwards mass
    matrix, bias and frames are those of t_k+1; contact wrenches and acceleration are the means
    over the step, as a sensor would have them at t_k+1.
    """

    def __init__(
        self,
        scene: str | Path | SceneDescription,
        control_dt: float = CONTROL_DT,
        physics_dt: float = PHYSICS_DT,
        joint_names: Sequence[str] | None = None,
        disturbances: Disturbances | None = None,
    ) -> None:
        """Load a scene and put the robot at its start.

        Args:
            scene: name, path or description of the scene.
            control_dt: how long a torque is held, one `step` [s]; a multiple of physics_dt.
            physics_dt: step of the integrator [s].
            joint_names: joint order of the robot model; that of MuJoCo when not given.
            disturbances: other masses and friction, and a push; none when not given.

        Raises:
            InvalidValue: the periods do not fit.
            ConfigurationError, UnknownName: scene, robot or joints cannot be used.
        """
        self.substeps = count_substeps(control_dt, physics_dt)
        self.control_dt = control_dt
        self.scene = scene if isinstance(scene, SceneDescription) else load_scene(scene)
        self.model = build_model(self.scene, control_dt / self.substeps)
        self._disturbances = disturbances
        if disturbances is not None:
            disturbances.change(self.model)
        self.data = mujoco.MjData(self.model)
        simulated = joints_of(self.model)
        joints = JointMap(simulated if joint_names is None else joint_names, simulated)
        self.joint_names = names = joints.names
        self.floating_base = self.scene.base is not None
        self._coordinates = FloatingBase(joints) if self.floating_base else FixedBase(joints)
        self.nq, self.nv = self._coordinates.nq, self._coordinates.nv
        self.base_frame = base_frame_of(self.model)
        model = self.scene.robot.model
        order, limits = [model.joint_index(name) for name in names], model.limits
        self.torque_limit: Array = overridden(
            limits.torque[order], self.scene.torque_limit, names, "torque"
        )
        self.velocity_limit: Array = limits.velocity[order]
        self.position_limits: Array = np.stack(
            [limits.position_lower[order], limits.position_upper[order]], axis=1
        )
        self._contacts = ContactSensors(self.model, self.scene.contacts)
        self._mass_buffer = np.zeros((self.model.nv, self.model.nv))
        self.start: Array = self._start()
        self.epoch = -1
        self.reset()

    @property
    def time(self) -> float:
        """Simulated time since the last reset [s]: an exact count of periods, not a sum."""
        return self.tick * self.control_dt

    def _start(self) -> Array:
        """The scene's start (nq,): joints [rad], behind the base's pose if that floats."""
        scene = self.scene
        unknown = [name for name in scene.start if name not in self.joint_names]
        if unknown:
            raise UnknownName(f"joint in 'start' of {scene.file}", unknown[0], self.joint_names)
        joints = np.array([scene.start.get(name, 0.0) for name in self.joint_names])
        self._check_start(joints)
        if scene.base is None:
            return joints
        self.data.qpos[:] = self._coordinates.configuration_to_simulator(
            np.concatenate([_BASE_AT_ORIGIN, joints])
        )
        mujoco.mj_kinematics(self.model, self.data)
        places = {
            name: (self.frame_position(name), self.frame_rotation(name))
            for name in scene.base.frames
        }
        return np.concatenate([base_pose(scene.base, places), joints])

    def _check_start(self, joints: Array) -> None:
        """Raise ConfigurationError for a start far beyond a position limit, as of degrees."""
        scene = self.scene
        for name, value, limits in zip(
            self.joint_names, joints, self.position_limits, strict=True
        ):
            lower, upper = limits
            if name in scene.start and not lower - _BEYOND <= value <= upper + _BEYOND:
                raise ConfigurationError(
                    f"{scene.file}: start.{name}: {value:g} is beyond the joint's limits, "
                    f"{lower:g} to {upper:g}; radians (or meters) expected"
                )

    def reset(self, q: ArrayLike | None = None, v: ArrayLike | None = None) -> None:
        """Back to t = 0 at q (nq,) (the scene's start) and velocity v (nv,) (zero).

        The applied torque becomes the one that carries the robot there: a rate limit then starts
        from a torque that means something.
        """
        configuration = self.start if q is None else self._checked("posture", q, self.nq)
        velocity = np.zeros(self.nv) if v is None else self._checked("velocity", v, self.nv)
        qpos = self._coordinates.configuration_to_simulator(configuration)
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = qpos
        self.data.qvel[:] = self._coordinates.velocity_to_simulator(qpos, velocity)
        mujoco.mj_step1(self.model, self.data)
        self._contacts.clear()
        self.tick = 0
        self.epoch += 1
        self.acceleration: Array = np.zeros(len(self.joint_names))  # (na,) mean over the last step
        self.torque: Array = self._carrying_torque()  # (na,) [Nm] applied over the last step

    def _carrying_torque(self) -> Array:
        if not self.floating_base:
            return self.bias()
        state = self.data.qvel.copy()
        self.data.qvel[:] = 0.0
        mujoco.mj_step1(self.model, self.data)
        still = np.zeros(self.nv)
        torque = standing_torque(
            self.dynamics(), self.contact_jacobian(), still, np.zeros(len(self.joint_names))
        )
        self.data.qvel[:] = state
        mujoco.mj_step1(self.model, self.data)
        return np.clip(torque, -self.torque_limit, self.torque_limit)

    def step(self, torque: ArrayLike) -> None:
        """Hold a torque (na,) [Nm] of the motors for one control period.

        Raises WrongSize or InvalidValue (naming the joint) for a torque that cannot be applied,
        SimulationDiverged when the state leaves what can be believed.
        """
        applied = self._checked("torque", torque, len(self.joint_names), LARGEST_TORQUE)
        model, data = self.model, self.data
        before = data.qvel.copy()
        data.qfrc_applied[:] = self._coordinates.torque_to_simulator(applied)
        self._contacts.clear()
        for _ in range(self.substeps):
            if self._disturbances is not None:
                self._disturbances.push(model, data)
            mujoco.mj_step2(model, data)
            self._contacts.add(data, 1.0 / self.substeps)
            mujoco.mj_step1(model, data)
        self.tick += 1
        self.torque = applied
        change = self._coordinates.velocity(data.qpos, data.qvel - before)
        self.acceleration = change[-len(applied) :] / self.control_dt
        self._check_state()

    def state(self) -> RobotState:
        """The state now; its torque and wrenches are those of the last step."""
        return RobotState(
            time=self.time,
            q=self._coordinates.configuration(self.data.qpos),
            v=self._coordinates.velocity(self.data.qpos, self.data.qvel),
            torque=self.torque,
            wrenches=self.contact_wrenches(),
            epoch=self.epoch,
        )

    def measured_velocity(self, velocity: Array) -> Array:
        """Joint velocities (na,) [rad/s] as sensors have them: fresh noise where there is any."""
        if self._disturbances is None:
            return velocity
        return self._disturbances.measured(velocity)

    def contact_wrenches(self) -> Mapping[str, Array]:
        """Name -> (6,) force [N] and torque [Nm] of the environment on the robot at the
        contact's frame, world axes; mean over the last step."""
        return self._contacts.wrenches()

    def mass_matrix(self) -> Array:
        """M(q) (nv, nv) [kg m^2]."""
        return self._coordinates.mass_matrix(self.data.qpos, self._native_mass())

    def bias(self) -> Array:
        """h(q, v) (nv,) [Nm]: Coriolis, centrifugal and gravity torques."""
        data = self.data
        # The mass matrix is for the term that only a floating base has.
        mass = self._native_mass() if self.floating_base else self._mass_buffer
        return self._coordinates.bias(data.qpos, data.qvel, data.qfrc_bias, mass)

    def dynamics(self) -> Dynamics:
        """M and h together."""
        return Dynamics(self.mass_matrix(), self.bias())

    def _native_mass(self) -> Array:
        mujoco.mj_fullM(self.model, self.data, self._mass_buffer)
        return self._mass_buffer

    def hold_torque(self, state: RobotState | None = None) -> Array:
        """Torque (n,) [Nm] that brakes a robot with a fixed base and carries its weight, within
        its limits.

        Mass matrix and bias are those of the present; `state` may give another velocity.
        """
        velocity = self.state().v if state is None else state.v
        return braking_torque(
            self.dynamics(), velocity, self.torque_limit, max_acceleration=np.inf
        )

    def contact_jacobian(self) -> Array:
        """(m, nv) velocity per joint velocity of the points that touch now: the normal of each,
        and both tangents where there is friction."""
        rows = self._contacts.jacobian(self.data)
        return self._coordinates.jacobian(self.data.qpos, rows)

    def frame_position(self, frame: str) -> Array:
        """Origin of a frame of the URDF (3,) [m], world."""
        return np.array(self.data.site_xpos[self._site(frame)])

    def frame_rotation(self, frame: str) -> Array:
        """Axes of a frame as columns (3, 3), world."""
        return np.array(self.data.site_xmat[self._site(frame)]).reshape(3, 3)

    def frame_jacobian(self, frame: str) -> Array:
        """(6, nv) linear then angular velocity of a frame per velocity, world axes."""
        jacobian = np.zeros((6, self.model.nv))
        mujoco.mj_jacSite(self.model, self.data, jacobian[:3], jacobian[3:], self._site(frame))
        return self._coordinates.jacobian(self.data.qpos, jacobian)

    def _site(self, frame: str) -> int:
        site = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, frame)
        if site < 0:
            names = [self.model.site(k).name for k in range(self.model.nsite)]
            raise UnknownName("frame", frame, names)
        return int(site)

    def _checked(self, what: str, values: ArrayLike, size: int, largest: float = np.inf) -> Array:
        array = np.array(values, dtype=float)
        if array.shape != (size,):
            base = "the base and " if size > len(self.joint_names) else ""
            raise WrongSize(f"{what} of {base}{', '.join(self.joint_names)}", array.shape, (size,))
        bad = ~(np.abs(array) < largest)
        if bad.any():
            k = int(np.argmax(bad))
            raise InvalidValue(f"{what} of {self._owner(k, size)} is {array[k]:g}")
        return array

    def _owner(self, index: int, size: int) -> str:
        """Whose coordinate it is, of `size` coordinates with the joints at the end."""
        joint = index - (size - len(self.joint_names))
        return self.joint_names[joint] if joint >= 0 else "the base"

    def _check_state(self) -> None:
        speed = np.abs(self.data.qvel)
        if speed.max(initial=0.0) < LARGEST_SPEED and np.isfinite(self.data.qpos).all():
            return
        values = self._coordinates.velocity(self.data.qpos, self.data.qvel)
        worst = int(np.argmax(np.where(np.isnan(values), np.inf, np.abs(values))))
        raise SimulationDiverged(
            self._owner(worst, self.nv), "velocity", values[worst], "rad/s", self.time
        )
