"""Between the coordinates of the robot model (Pinocchio's) and those of the simulator (MuJoCo's).

Joints are matched by name. With a floating base both put it first, in different terms:

    model:      q = [p, quaternion xyzw, joints]   v = [R^T dp/dt, w in base axes, joints]
    simulator:  q = [p, quaternion wxyz, joints]   v = [dp/dt, w in base axes, joints]

with R the base's rotation and dp/dt in world axes. So v_model = T v_sim, T = blkdiag(R^T, I, P),
P the permutation of the joints, and with T orthogonal M_model = T M_sim T^T, J_model = J_sim T^T.
The bias needs one term more: h_model = T h_sim - M_model (dT/dt v_sim), with
dT/dt v_sim = [-w x (R^T dp/dt), 0, 0].
"""

from __future__ import annotations

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.numerics.rotation import matrix_from_quaternion
from ghc_controller.types import Array
from ghc_sim_bridge.simulation.joint_map import JointMap

QUATERNION_TOLERANCE = 1e-6  # [-] of its norm
_BASE_NQ, _BASE_NV = 7, 6
_XYZW = np.array([4, 5, 6, 3])  # of the quaternion in a configuration of the simulator


class FixedBase:
    """Coordinates are the joints' alone."""

    def __init__(self, joints: JointMap) -> None:
        self._joints = joints
        self.nq = self.nv = len(joints.names)

    def configuration_to_simulator(self, q: Array) -> Array:
        """(nq,) of the model, in the simulator's terms."""
        return self._joints.to_simulator(q)

    def configuration(self, qpos: Array) -> Array:
        """(nq,) of the simulator, in the model's terms."""
        return self._joints.from_simulator(qpos)

    def velocity_to_simulator(self, _qpos: Array, v: Array) -> Array:
        """(nv,) of the model at the simulator's configuration, in the simulator's terms."""
        return self._joints.to_simulator(v)

    def velocity(self, _qpos: Array, qvel: Array) -> Array:
        """(nv,) of the simulator, in the model's terms."""
        return self._joints.from_simulator(qvel)

    def mass_matrix(self, _qpos: Array, mass: Array) -> Array:
        """(nv, nv)."""
        return self._joints.from_simulator(mass)

    def bias(self, _qpos: Array, _qvel: Array, bias: Array, _mass: Array) -> Array:
        """(nv,); `_mass` is the simulator's mass matrix, up to date."""
        return self._joints.from_simulator(bias)

    def jacobian(self, _qpos: Array, jacobian: Array) -> Array:
        """(m, nv) of the simulator, for velocities of the model."""
        return self._joints.columns_from_simulator(jacobian)

    def torque_to_simulator(self, torque: Array) -> Array:
        """(na,) [Nm] of the motors as generalized forces (nv,)."""
        return self._joints.to_simulator(torque)


class FloatingBase(FixedBase):
    """Six free coordinates before the joints."""

    def __init__(self, joints: JointMap) -> None:
        super().__init__(joints)
        self.nq += _BASE_NQ
        self.nv += _BASE_NV

    def configuration_to_simulator(self, q: Array) -> Array:
        """See FixedBase; InvalidValue for a quaternion that is none."""
        norm = float(np.linalg.norm(q[3:7]))
        if not abs(norm - 1.0) < QUATERNION_TOLERANCE:
            raise InvalidValue(f"quaternion of the base has the norm {norm:g}, 1 expected")
        return np.concatenate([q[:3], q[6:7], q[3:6], self._joints.to_simulator(q[7:])])

    def configuration(self, qpos: Array) -> Array:
        """See FixedBase."""
        joints = self._joints.from_simulator(qpos[7:])
        return np.concatenate([qpos[:3], qpos[4:7], qpos[3:4], joints])

    def velocity_to_simulator(self, qpos: Array, v: Array) -> Array:
        """See FixedBase."""
        linear = rotation(qpos) @ v[:3]
        return np.concatenate([linear, v[3:6], self._joints.to_simulator(v[6:])])

    def velocity(self, qpos: Array, qvel: Array) -> Array:
        """See FixedBase."""
        linear = qvel[:3] @ rotation(qpos)
        return np.concatenate([linear, qvel[3:6], self._joints.from_simulator(qvel[6:])])

    def mass_matrix(self, qpos: Array, mass: Array) -> Array:
        """See FixedBase."""
        return self.jacobian(qpos, self.jacobian(qpos, mass).T)

    def bias(self, qpos: Array, qvel: Array, bias: Array, mass: Array) -> Array:
        """See FixedBase."""
        linear = qvel[:3] @ rotation(qpos)
        drift = np.zeros(self.nv)
        drift[:3] = np.cross(linear, qvel[3:6])
        turned = self.jacobian(qpos, bias[None])[0]
        return np.asarray(turned - self.mass_matrix(qpos, mass) @ drift)

    def jacobian(self, qpos: Array, jacobian: Array) -> Array:
        """See FixedBase: columns of the linear velocity turn, those of the joints move."""
        result = np.empty_like(jacobian)
        result[:, :3] = jacobian[:, :3] @ rotation(qpos)
        result[:, 3:6] = jacobian[:, 3:6]
        result[:, 6:] = self._joints.columns_from_simulator(jacobian[:, 6:])
        return result

    def torque_to_simulator(self, torque: Array) -> Array:
        """See FixedBase: no motor moves the base."""
        return np.concatenate([np.zeros(_BASE_NV), self._joints.to_simulator(torque)])


def rotation(qpos: Array) -> Array:
    """(3, 3) of the base, from the simulator's configuration."""
    return np.asarray(matrix_from_quaternion(qpos[_XYZW]))
