"""The joints of a robot, with a floating base that stays where it was."""

from __future__ import annotations

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array, RobotState


class HeldBase:
    """Updates a model from the positions and velocities of its joints, (n,) each.

    The base is at rest at the pose it had at the last `hold`; a fixed base needs none. Jacobian
    columns of the base are removed, and with its velocity zero J v and dJ/dt v are those of the
    joints.

    Attributes:
        model: for the tasks, current after `update`.
        n: number of joints.
    """

    def __init__(self, model: RobotModel) -> None:
        """Take the pose of the base from the model."""
        self.model, self.n = model, model.na
        self._q, self._v = model.q.copy(), np.zeros(model.nv)

    def hold(self, state: RobotState) -> Array:
        """Leave the base where it is in a state; joint positions (n,) of the state."""
        self._q[: -self.n] = state.q[: -self.n]
        joints: Array = state.q[-self.n :].copy()
        return joints

    def update(self, q: Array, v: Array | None = None) -> None:
        """Update the model at joint positions and velocities (n,), at rest without the latter."""
        self._q[-self.n :] = q
        self._v[-self.n :] = 0.0 if v is None else v
        self.model.update(self._q, self._v)

    def columns(self, jacobian: Array) -> Array:
        """(m, n) of the joints from (m, nv)."""
        return np.ascontiguousarray(jacobian[:, -self.n :])
