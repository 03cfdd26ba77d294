"""A posture in which a legged robot stands with bent knees, its center of mass over its feet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.rotation import quaternion_from_matrix, rotation_log
from ghc_controller.robot.first_files.feet import Foot
from ghc_controller.types import Array

_CROUCH = 0.08  # [-] of the height of the base over the feet, by which it comes down
_SEED, _TRIES = 0, 12
_SPREAD = 0.5  # [rad] of the legs' postures from which one is looked for
_STAY = (0.02,) * 40 + (0.002,) * 20  # [-] weight of the joints' posture in each step
_INSIDE = 0.05  # [-] of the range that stays free at both ends
_DAMPING = 1e-3
_LARGEST = 0.3  # [rad] step
_MET = 2e-3  # [m] and [rad]


def standing_posture(model: RobotModel, feet: Sequence[Foot], q: Array) -> Array:
    """Joints (a,): feet as at configuration q (nq,), the level base lower, balanced.

    Of those found from 12 starts the one nearest to q; joints that no foot needs hardly move.

    Raises:
        ConfigurationError: none was found; asks for a posture of an SRDF.
    """
    rng = np.random.default_rng(_SEED)
    first = model.nq - model.na
    margin = _INSIDE * (model.position_upper - model.position_lower)
    low, high = model.position_lower + margin, model.position_upper - margin
    nominal = np.clip(q[first:], low, high)
    wanted = _Stance(model, feet, q)
    legs = np.zeros(model.na)
    legs[[joint - (model.nv - model.na) for foot in feet for joint in foot.joints]] = 1.0
    best: Array | None = None
    for _ in range(_TRIES):
        joints = np.clip(nominal + legs * rng.uniform(-_SPREAD, _SPREAD, model.na), low, high)
        for stay in _STAY:
            error, jacobian = wanted.at(joints)
            rows = np.vstack([jacobian, stay * np.eye(model.na)])
            right = np.concatenate([error, stay * (nominal - joints)])
            normal = rows.T @ rows + _DAMPING**2 * np.eye(model.na)
            step = np.linalg.solve(normal, rows.T @ right)
            joints = np.clip(joints + np.clip(step, -_LARGEST, _LARGEST), low, high)
        error, _ = wanted.at(joints)
        near = best is None or np.abs(joints - nominal).max() < np.abs(best - nominal).max()
        if np.abs(error).max() <= _MET and near:
            best = joints
    if best is None:
        raise ConfigurationError(
            "no posture was found in which the robot stands; give one by --srdf and --pose"
        )
    return best


class _Stance:
    """Where the feet shall be below the base, and the center of mass over them."""

    def __init__(self, model: RobotModel, feet: Sequence[Foot], q: Array) -> None:
        self._model, self._feet, self._q = model, feet, q.copy()
        self._frames = [model.frame_id(foot.frame) for foot in feet]
        model.update(q, np.zeros(model.nv))
        self._places = np.array([model.frame_position(frame).copy() for frame in self._frames])
        self._turns = [model.frame_rotation(frame).copy() for frame in self._frames]
        self._places[:, 2] *= 1.0 - _CROUCH

    def at(self, joints: Array) -> tuple[Array, Array]:
        """Errors (r,) and their Jacobian (r, a) with respect to the joints."""
        model, count = self._model, len(self._feet)
        self._q[model.nq - model.na :] = joints
        model.update(self._q, np.zeros(model.nv))
        first = model.nv - model.na
        moved = [model.frame_jacobian(frame)[:, first:].copy() for frame in self._frames]
        places = np.array([model.frame_position(frame) for frame in self._frames])
        mean, mean_rows = places.mean(axis=0), sum(rows[:3] for rows in moved) / count
        errors, jacobians = [], []
        for k, foot in enumerate(self._feet):
            relative = self._places[k] - self._places.mean(axis=0) - (places[k] - mean)
            relative[2] = self._places[k, 2] - places[k, 2]
            rows = moved[k][:3] - mean_rows
            rows[2] = moved[k][2]
            errors.append(relative)
            jacobians.append(rows)
            if len(foot.points) > 1:
                turn = self._turns[k] @ model.frame_rotation(self._frames[k]).T
                errors.append(rotation_log(quaternion_from_matrix(np.ascontiguousarray(turn))))
                jacobians.append(moved[k][3:])
        center = model.center_of_mass()
        errors.append((mean - center)[:2])
        jacobians.append((model.center_of_mass_jacobian()[:, first:] - mean_rows)[:2])
        return np.concatenate(errors), np.vstack(jacobians)
