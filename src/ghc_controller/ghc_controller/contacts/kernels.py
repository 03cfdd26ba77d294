"""Compiled inner loops of the contacts."""

from __future__ import annotations

import numba
import numpy as np

from ghc_controller.types import Array


@numba.njit(cache=True)
def point_rows(
    rotation: Array, jacobian: Array, points: Array, axes: Array, out: Array
) -> None:  # pragma: no cover
    """Jacobian of points of a frame along given axes, (p * a, n), point by point.

    rotation (3, 3) frame to world, jacobian (6, n) of its origin in world axes, points (p, 3) in
    the frame, axes (a, 3) in the world: row = axis . (J_lin + J_ang x (R point)).
    """
    n = jacobian.shape[1]
    arm = np.empty(3)
    for p in range(points.shape[0]):
        for i in range(3):
            arm[i] = 0.0
            for j in range(3):
                arm[i] += rotation[i, j] * points[p, j]
        for a in range(axes.shape[0]):
            row = out[p * axes.shape[0] + a]
            x, y, z = axes[a, 0], axes[a, 1], axes[a, 2]
            # axis . (w x arm) = w . (arm x axis)
            u = arm[1] * z - arm[2] * y
            v = arm[2] * x - arm[0] * z
            w = arm[0] * y - arm[1] * x
            for c in range(n):
                row[c] = (
                    x * jacobian[0, c]
                    + y * jacobian[1, c]
                    + z * jacobian[2, c]
                    + u * jacobian[3, c]
                    + v * jacobian[4, c]
                    + w * jacobian[5, c]
                )


@numba.njit(cache=True)
def point_motion(
    rotation: Array,
    velocity: Array,
    drift: Array,
    points: Array,
    axes: Array,
    rate: float,
    out: Array,
) -> None:  # pragma: no cover
    """Accelerations (p * a,) that keep points still: -dJ/dt v - rate * velocity, along the axes.

    velocity and drift (6,) of the frame's origin, world axes. A point at arm r has the drift
    a + b x r + w x (w x r).
    """
    arm = np.empty(3)
    turn = np.empty(3)
    for p in range(points.shape[0]):
        for i in range(3):
            arm[i] = 0.0
            for j in range(3):
                arm[i] += rotation[i, j] * points[p, j]
        w0, w1, w2 = velocity[3], velocity[4], velocity[5]
        turn[0] = w1 * arm[2] - w2 * arm[1]
        turn[1] = w2 * arm[0] - w0 * arm[2]
        turn[2] = w0 * arm[1] - w1 * arm[0]
        b0, b1, b2 = drift[3], drift[4], drift[5]
        d0 = drift[0] + b1 * arm[2] - b2 * arm[1] + w1 * turn[2] - w2 * turn[1]
        d1 = drift[1] + b2 * arm[0] - b0 * arm[2] + w2 * turn[0] - w0 * turn[2]
        d2 = drift[2] + b0 * arm[1] - b1 * arm[0] + w0 * turn[1] - w1 * turn[0]
        for a in range(axes.shape[0]):
            x, y, z = axes[a, 0], axes[a, 1], axes[a, 2]
            speed = x * (velocity[0] + turn[0]) + y * (velocity[1] + turn[1])
            speed += z * (velocity[2] + turn[2])
            out[p * axes.shape[0] + a] = -(x * d0 + y * d1 + z * d2) - rate * speed
