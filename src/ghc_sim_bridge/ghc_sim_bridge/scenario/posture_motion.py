"""References of a motion between postures: where its frames and its centre of mass come along.

A motion such as standing up is easily said in joint angles, but followed by tasks on the centre of
mass and on orientations. Postures at times, interpolated with minimum jerk, give those by forward
kinematics of a robot that stands on given frames.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array
from ghc_sim_bridge.scene.values import BaseStart
from ghc_sim_bridge.simulation.base_start import base_pose

_AT_ORIGIN = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])


class Posture(NamedTuple):
    """Joints at a time; the robot is at rest there."""

    time: float  # [s]
    joints: Mapping[str, float]  # [rad]; a joint left out is at 0


def configuration(model: RobotModel, start: BaseStart, joints: Array) -> Array:
    """q (nq,) of a floating robot that stands on its frames with joints (na,) [rad].

    Updates the model. Raises UnknownName for a frame.
    """
    still = np.zeros(model.nv)
    ids = {name: model.frame_id(name) for name in start.stand_on}
    model.update(np.concatenate([_AT_ORIGIN, joints]), still)
    places = {
        name: (model.frame_position(k).copy(), model.frame_rotation(k).copy())
        for name, k in ids.items()
    }
    q = np.concatenate([base_pose(start, places), joints])
    model.update(q, still)
    return q


def sampled_motion(
    model: RobotModel,
    start: BaseStart,
    postures: Sequence[Posture],
    read: Callable[[RobotModel], Array],
    step: float = 0.02,
) -> tuple[Array, Array]:
    """Times (T,) [s] and what `read` finds in the updated model, (T, m), from first to last.

    `read` is for instance a task's `current`: the samples are then points of its reference.

    Raises:
        InvalidValue: fewer than two postures, or times that do not increase.
        UnknownName: a joint or frame that the robot has not.
    """
    times = np.array([posture.time for posture in postures])
    if len(times) < 2 or not (np.diff(times) > 0.0).all() or not step > 0.0:
        raise InvalidValue(f"two or more postures at increasing times expected, {times} given")
    rows = np.zeros((len(postures), model.na))
    for row, posture in zip(rows, postures, strict=True):
        for name, angle in posture.joints.items():
            row[model.joint_index(name)] = angle
    count = round((times[-1] - times[0]) / step)
    samples = np.append(times[0] + step * np.arange(count), times[-1])
    values = []
    for time in samples:
        k = int(np.clip(np.searchsorted(times, time, "right") - 1, 0, len(times) - 2))
        share = minimum_jerk((time - times[k]) / (times[k + 1] - times[k]))
        configuration(model, start, rows[k] + share * (rows[k + 1] - rows[k]))
        values.append(np.array(read(model)))
    return samples, np.stack(values)


def minimum_jerk(share: float) -> float:
    """Part of the way after a share of the time, both in [0, 1]; at rest at both ends."""
    return float(share**3 * (10.0 - 15.0 * share + 6.0 * share**2))
