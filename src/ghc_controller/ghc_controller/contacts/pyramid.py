"""Friction pyramid of one point."""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array

CARRIES = 0.1  # [N] normal force below which the friction ratio is noise
_PYRAMID = np.sqrt(2.0)  # a pyramid with friction mu / sqrt(2) lies inside the cone with mu


def point_cone(friction: float, axes: Array) -> Array:
    """Rows at most 0 (thesis, eq. 5.3) of one point with forces along axes (a, 3).

    A pyramid of four rows where a = 3, the normal last; only -F_n where a = 1.
    """
    if axes.shape[0] == 1:
        return np.array([[-1.0]])
    rows = np.zeros((4, 3))
    for k, (axis, sign) in enumerate(((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0))):
        rows[k, axis] = sign
        rows[k, 2] = -friction / _PYRAMID
    return rows


def largest_friction_use(force: Array, friction: float) -> float:
    """Largest |F_t| / (mu F_n) [-] of forces (p, 3) [N], the normal last; 0 below `CARRIES`."""
    carrying = force[force[:, 2] > CARRIES]
    if not carrying.shape[0]:
        return 0.0
    tangential = np.linalg.norm(carrying[:, :2], axis=1)
    return float((tangential / (friction * carrying[:, 2])).max())
