"""Mass of a robot, where its center is, and the torques against gravity."""

from __future__ import annotations

import numba
import numpy as np
import pinocchio as pin

from ghc_controller.types import Array


class MassCenter:
    """Computed when it is first asked for after an update of the model's data.

    Attributes:
        mass: [kg]; weight: [N].
    """

    def __init__(self, model: pin.Model, data: pin.Data, q: Array, v: Array) -> None:
        """Follow `data`, which is updated at the state in the arrays q (nq,) and v (n,)."""
        self._model, self._data, self._q, self._v = model, data, q, v
        self.mass = float(pin.computeTotalMass(model))
        self._gravity_vector = np.array(model.gravity.linear)
        self.weight = self.mass * float(np.linalg.norm(self._gravity_vector))
        # Views taken once: fetching them from pin.Data costs more than the copy.
        self._momentum_view = data.Ag.reshape((6, model.nv), order="F")
        self._views = (data.com[0], data.vcom[0], data.acom[0])
        self._zero = np.zeros(model.nv)
        self._gravity: Array | None = None
        self._is_current = False

    def expire(self) -> None:
        """The data were updated."""
        self._gravity = None
        self._is_current = False

    def gravity(self) -> Array:
        """Torque that holds the robot still, the bias at v = 0: (n,) [Nm] or [N]."""
        if self._gravity is None:
            self._gravity = _gravity_torque(self._momentum_view, self._gravity_vector)
        return self._gravity

    def position(self) -> Array:
        """In the world, (3,) [m]."""
        self._compute()
        return self._views[0]

    def velocity(self) -> Array:
        """(3,) [m/s]."""
        self._compute()
        return self._views[1]

    def drift(self) -> Array:
        """dJ/dt v, (3,) [m/s^2]."""
        self._compute()
        return self._views[2]

    def jacobian(self) -> Array:
        """(3, n) fresh array: linear rows of the momentum matrix over the mass."""
        return np.ascontiguousarray(self._momentum_view[:3]) / self.mass

    def _compute(self) -> None:
        if not self._is_current:
            pin.centerOfMass(self._model, self._data, self._q, self._v, self._zero)
            self._is_current = True


@numba.njit(cache=True)
def _gravity_torque(momentum: Array, gravity: Array) -> Array:
    """Minus the weight, by the linear rows of the momentum matrix (6, n); (n,)."""
    torque = np.zeros(momentum.shape[1])
    for j in range(torque.shape[0]):
        for i in range(3):
            torque[j] -= gravity[i] * momentum[i, j]
    return torque
