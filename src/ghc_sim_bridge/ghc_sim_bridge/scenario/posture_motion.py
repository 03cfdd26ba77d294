"""Base pose of a standing robot, from the frames that it stands on."""

from __future__ import annotations

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array
from ghc_sim_bridge.scene.values import BaseStart
from ghc_sim_bridge.simulation.base_start import base_pose

_AT_ORIGIN = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])


def configuration(model: RobotModel, start: BaseStart, joints: Array) -> Array:
    """q (nq,) of a floating-base robot that stands on given frames, with joints (na,) [rad].

    Updates the model. Raises UnknownName for a frame.
    """
    still = np.zeros(model.nv)
    ids = {name: model.frame_id(name) for name in start.frames}
    model.update(np.concatenate([_AT_ORIGIN, joints]), still)
    places = {
        name: (model.frame_position(k).copy(), model.frame_rotation(k).copy())
        for name, k in ids.items()
    }
    q = np.concatenate([base_pose(start, places), joints])
    model.update(q, still)
    return q
