"""How a frame is seen: what measures its rows, its terms, and their curvature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ghc_controller.core import FrameMeasure
from ghc_controller.model.frames import FrameTerms
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.curvature import point_curvature, rotation_curvature
from ghc_controller.types import Array


class Sight(Protocol):
    """A frame as seen from somewhere: from the world, or from another frame."""

    def measure(self, rows: Sequence[int]) -> FrameMeasure:
        """What measures chosen rows of x, y, z, rx, ry, rz (0 to 5)."""

    def terms(self, model: RobotModel) -> FrameTerms:
        """Pose, Jacobian and drift at the last `model.update`, in the axes it is seen in."""

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """sum_r weights_r grad^2 of the six coordinates, (n, n); weights (6,)."""


class FromWorld:
    """A frame as seen from the world, in world axes."""

    def __init__(self, frame_id: int) -> None:
        self._frame_id = frame_id

    def measure(self, rows: Sequence[int]) -> FrameMeasure:
        """See Sight."""
        return FrameMeasure(list(rows), self._frame_id, -1)

    def terms(self, model: RobotModel) -> FrameTerms:
        """See Sight."""
        return model.frame(self._frame_id)

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """See Sight."""
        jacobian = model.frame_jacobian(self._frame_id)
        term = np.zeros((model.nv, model.nv))
        if weights[:3].any():
            term += point_curvature(model, jacobian[3:], jacobian[:3], weights[:3])
        if weights[3:].any():
            term += rotation_curvature(model, jacobian[3:], weights[3:])
        return term
