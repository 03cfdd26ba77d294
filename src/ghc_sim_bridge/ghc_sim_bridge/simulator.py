"""The simulated robot: apply a torque, step, read the state. MuJoCo inside, no ROS.

Everything is in the joint order of the robot model (`joint_names`); MuJoCo's order stays inside.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.types import RobotState
from ghc_sim_bridge.contact_sensors import ContactSensors
from ghc_sim_bridge.errors import SimulationDiverged
from ghc_sim_bridge.hold import hold_torque
from ghc_sim_bridge.joint_map import JointMap
from ghc_sim_bridge.scene import build_model
from ghc_sim_bridge.scene_description import SceneDescription, load_scene
from ghc_sim_bridge.timing import count_substeps
from ghc_sim_bridge.urdf_limits import read_limits

Array = NDArray[np.float64]

LARGEST_SPEED = 1e3  # [rad/s] beyond it a state is diverged, not fast
LARGEST_TORQUE = 1e6  # [Nm] beyond it a torque is a mistake, not a command


class Simulator:
    """One robot in its scene, moved by joint torques.

    A step runs from the state at t_k under a torque that is held until t_k+1. Afterwards mass
    matrix, bias and frames are those of t_k+1; contact wrenches and acceleration are the means
    over the step, as a sensor would have them at t_k+1.
    """

    def __init__(
        self,
        scene: str | Path | SceneDescription,
        control_dt: float = 1e-3,
        physics_dt: float = 1e-3,
        joint_names: Sequence[str] | None = None,
    ) -> None:
        """Load a scene and put the robot at its start.

        Args:
            scene: name, path or description of the scene.
            control_dt: how long a torque is held, one `step` [s]; a multiple of physics_dt.
            physics_dt: step of the integrator [s].
            joint_names: joint order of the robot model; that of the URDF when not given.

        Raises:
            InvalidValue: the periods do not fit.
            ConfigurationError, UnknownName: scene, robot or joints cannot be used.
        """
        self.substeps = count_substeps(control_dt, physics_dt)
        self.control_dt = control_dt
        self.scene = scene if isinstance(scene, SceneDescription) else load_scene(scene)
        self.model = build_model(self.scene, control_dt / self.substeps)
        self.data = mujoco.MjData(self.model)
        native_names = tuple(self.model.joint(k).name for k in range(self.model.njnt))
        limits = read_limits(self.scene.urdf)
        self._joints = JointMap(
            tuple(limits) if joint_names is None else joint_names, native_names
        )
        self.joint_names = self._joints.names
        self.torque_limit: Array = np.array([limits[n].torque for n in self.joint_names])
        self.velocity_limit: Array = np.array([limits[n].velocity for n in self.joint_names])
        self.position_limits: Array = np.array([limits[n].position for n in self.joint_names])
        self._contacts = ContactSensors(self.model, self.scene.contacts)
        self._mass_buffer = np.zeros((self.model.nv, self.model.nv))
        self.epoch = -1
        self.reset()

    @property
    def time(self) -> float:
        """Simulated time since the last reset [s]: an exact count of periods, not a sum."""
        return self.tick * self.control_dt

    @property
    def start(self) -> Array:
        """The scene's start posture (n,) [rad]."""
        unknown = [name for name in self.scene.start if name not in self.joint_names]
        if unknown:
            raise UnknownName(
                f"joint in 'start' of {self.scene.file}", unknown[0], self.joint_names
            )
        return np.array([self.scene.start.get(name, 0.0) for name in self.joint_names])

    def reset(self, q: ArrayLike | None = None, v: ArrayLike | None = None) -> None:
        """Back to t = 0 at posture q (n,) [rad] (the scene's start) and velocity v (n,) (zero).

        The applied torque becomes the one that carries the robot there: a rate limit then starts
        from a torque that means something.
        """
        n = len(self.joint_names)
        posture = self.start if q is None else self._checked("posture", q)
        velocity = np.zeros(n) if v is None else self._checked("velocity", v)
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self._joints.to_simulator(posture)
        self.data.qvel[:] = self._joints.to_simulator(velocity)
        mujoco.mj_step1(self.model, self.data)
        self._contacts.clear()
        self.tick = 0
        self.epoch += 1
        self.acceleration: Array = np.zeros(n)  # (n,) [rad/s^2] mean over the last step
        self.torque: Array = self.bias()  # (n,) [Nm] applied over the last step

    def step(self, torque: ArrayLike) -> None:
        """Hold a torque (n,) [Nm] for one control period.

        Raises WrongSize or InvalidValue (naming the joint) for a torque that cannot be applied,
        SimulationDiverged when the state leaves what can be believed.
        """
        applied = self._checked("torque", torque, LARGEST_TORQUE)
        model, data = self.model, self.data
        before = data.qvel.copy()
        data.qfrc_applied[:] = self._joints.to_simulator(applied)
        self._contacts.clear()
        for _ in range(self.substeps):
            mujoco.mj_step2(model, data)
            self._contacts.add(data, 1.0 / self.substeps)
            mujoco.mj_step1(model, data)
        self.tick += 1
        self.torque = applied
        self.acceleration = self._joints.from_simulator((data.qvel - before) / self.control_dt)
        self._check_state()

    def state(self) -> RobotState:
        """The state now; its torque and wrenches are those of the last step."""
        return RobotState(
            time=self.time,
            q=self._joints.from_simulator(self.data.qpos),
            v=self._joints.from_simulator(self.data.qvel),
            torque=self.torque,
            wrenches=self.contact_wrenches(),
            epoch=self.epoch,
        )

    def contact_wrenches(self) -> Mapping[str, Array]:
        """Name -> (6,) force [N] and torque [Nm] of the surroundings on the robot at the
        contact's frame, world axes; mean over the last step."""
        return self._contacts.wrenches()

    def mass_matrix(self) -> Array:
        """M(q) (n, n) [kg m^2]."""
        mujoco.mj_fullM(self.model, self.data, self._mass_buffer)
        return self._joints.from_simulator(self._mass_buffer)

    def bias(self) -> Array:
        """h(q, v) (n,) [Nm]: Coriolis, centrifugal and gravity torques."""
        return self._joints.from_simulator(self.data.qfrc_bias)

    def hold_torque(self, state: RobotState | None = None) -> Array:
        """Torque (n,) [Nm] that brakes the robot and carries its weight, within its limits.

        Mass matrix and bias are those of the present; `state` may give another velocity.
        """
        velocity = self._joints.from_simulator(self.data.qvel) if state is None else state.v
        return hold_torque(self.mass_matrix(), self.bias(), velocity, self.torque_limit)

    def frame_position(self, frame: str) -> Array:
        """Origin of a frame of the URDF (3,) [m], world."""
        return np.array(self.data.site_xpos[self._site(frame)])

    def frame_rotation(self, frame: str) -> Array:
        """Axes of a frame as columns (3, 3), world."""
        return np.array(self.data.site_xmat[self._site(frame)]).reshape(3, 3)

    def frame_jacobian(self, frame: str) -> Array:
        """(6, n) linear then angular velocity of a frame per joint velocity, world axes."""
        jacobian = np.zeros((6, self.model.nv))
        mujoco.mj_jacSite(self.model, self.data, jacobian[:3], jacobian[3:], self._site(frame))
        return self._joints.columns_from_simulator(jacobian)

    def _site(self, frame: str) -> int:
        site = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, frame)
        if site < 0:
            names = [self.model.site(k).name for k in range(self.model.nsite)]
            raise UnknownName("frame", frame, names)
        return int(site)

    def _checked(self, what: str, values: ArrayLike, largest: float = np.inf) -> Array:
        array = np.array(values, dtype=float)
        if array.shape != (len(self.joint_names),):
            raise WrongSize(
                f"{what} of {', '.join(self.joint_names)}", array.shape, (len(self.joint_names),)
            )
        bad = ~(np.abs(array) < largest)
        if bad.any():
            k = int(np.argmax(bad))
            raise InvalidValue(f"{what} of {self.joint_names[k]} is {array[k]:g}")
        return array

    def _check_state(self) -> None:
        speed = np.abs(self.data.qvel)
        if speed.max(initial=0.0) < LARGEST_SPEED and np.isfinite(self.data.qpos).all():
            return
        values = self._joints.from_simulator(self.data.qvel)
        worst = int(np.argmax(np.where(np.isnan(values), np.inf, np.abs(values))))
        raise SimulationDiverged(
            self.joint_names[worst], "velocity", values[worst], "rad/s", self.time
        )
