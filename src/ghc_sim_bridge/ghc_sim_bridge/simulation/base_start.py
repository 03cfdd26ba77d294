"""Where a floating base starts: on frames of the robot that lie flat, such as its soles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ghc_controller.types import Array
from ghc_sim_bridge.scene.values import BaseStart

Place = tuple[Array, Array]  # (3,) [m], (3, 3): of a frame in the axes of the base


def base_pose(start: BaseStart, places: Mapping[str, Place]) -> Array:
    """Pose of the base (7,): position [m] and quaternion xyzw, from the places of the frames.

    The first frame is flat (its z axis points up) with its x axis at the heading; the mean of
    all frames' origins is at `start.at`.
    """
    frames: Sequence[Place] = [places[name] for name in start.stand_on]
    angle = math.radians(start.heading)
    c, s = math.cos(angle), math.sin(angle)
    wanted = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turn = wanted @ frames[0][1].T
    middle = np.mean([position for position, _ in frames], axis=0)
    return np.concatenate([np.array(start.at) - turn @ middle, _quaternion(turn)])


def _quaternion(turn: Array) -> Array:
    """(4,) xyzw of a rotation matrix, by its largest component."""
    trace = float(np.trace(turn))
    k = int(np.argmax([*np.diag(turn), trace]))
    if k == 3:
        w = 0.5 * math.sqrt(1.0 + trace)
        skew = turn - turn.T
        quaternion = np.append(np.array([skew[2, 1], skew[0, 2], skew[1, 0]]) / (4.0 * w), w)
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        largest = 0.5 * math.sqrt(max(0.0, 1.0 + turn[k, k] - turn[i, i] - turn[j, j]))
        quaternion = np.empty(4)
        quaternion[k] = largest
        quaternion[i] = (turn[i, k] + turn[k, i]) / (4.0 * largest)
        quaternion[j] = (turn[j, k] + turn[k, j]) / (4.0 * largest)
        quaternion[3] = (turn[j, i] - turn[i, j]) / (4.0 * largest)
    return np.asarray(quaternion / np.linalg.norm(quaternion))
