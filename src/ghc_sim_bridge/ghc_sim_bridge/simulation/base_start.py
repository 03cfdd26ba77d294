"""Where a floating base starts: on frames of the robot that lie flat, such as its soles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ghc_controller.numerics.rotation import quaternion_from_matrix
from ghc_controller.types import Array
from ghc_sim_bridge.scene.values import BaseStart

Place = tuple[Array, Array]  # (3,) [m], (3, 3): of a frame in the axes of the base


def base_pose(start: BaseStart, places: Mapping[str, Place]) -> Array:
    """Pose of the base (7,): position [m] and quaternion xyzw, from the places of the frames.

    The level frame, which is the first one unless `start.level` names another, has its z axis up
    and its x axis at the heading; the mean of the origins of `stand_on` is at `start.at`.
    """
    frames: Sequence[Place] = [places[name] for name in start.stand_on]
    angle = math.radians(start.heading)
    c, s = math.cos(angle), math.sin(angle)
    wanted = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turn = wanted @ places[start.frames[0]][1].T
    middle = np.mean([position for position, _ in frames], axis=0)
    quaternion = quaternion_from_matrix(np.ascontiguousarray(turn))
    quaternion /= np.linalg.norm(quaternion)
    return np.concatenate([np.array(start.at) - turn @ middle, quaternion])
