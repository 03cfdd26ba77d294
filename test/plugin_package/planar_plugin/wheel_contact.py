"""A contact kind: wheels that roll along the first tangent and hold the second one."""

from __future__ import annotations

import numpy as np

from ghc_controller.contacts import Contact
from ghc_controller.types import Array


class WheelContact(Contact):
    """Each point is held along its axle and along the normal, with |F_axle| <= mu F_n."""

    @property
    def force_axes(self) -> Array:
        """Axle, then normal: (2, 3)."""
        return self.axes[[0, 2]]

    def cone(self) -> Array:
        """Two rows a point."""
        one = np.array([[1.0, -self.friction], [-1.0, -self.friction], [0.0, -1.0]])
        return np.kron(np.eye(self.points.shape[0]), one)

    def friction_use(self, force: Array) -> float:
        """Largest |F_axle| / (mu F_n) [-] of a point that carries more than 0.1 N."""
        carrying = force.reshape(-1, 2)[force[1::2] > 0.1]
        if not carrying.shape[0] or self.friction == 0.0:
            return 0.0
        return float((np.abs(carrying[:, 0]) / (self.friction * carrying[:, 1])).max())
