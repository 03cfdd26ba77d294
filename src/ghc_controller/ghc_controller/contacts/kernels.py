"""Compiled inner loops of the contacts."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from ghc_controller.numerics.small_factors import inverse_factor
from ghc_controller.types import Array


@numba.njit(cache=True)
def write_force_map(
    rotation: Array, jacobian: Array, points: Array, axes: Array, out: Array
) -> None:  # pragma: no cover
    """Write J_f (p * a, n), point by point: axis . (J_lin + J_ang x (R point)).

    rotation (3, 3) frame to world; jacobian (6, n) of its origin, world axes; points (p, 3) in the
    frame, axes (a, 3) in the world.
    """
    arm = np.empty(3)
    for p in range(points.shape[0]):
        _turned(rotation, points[p], arm)
        for k in range(axes.shape[0]):
            x, y, z = axes[k, 0], axes[k, 1], axes[k, 2]
            # axis . (w x arm) = w . (arm x axis)
            u, v, w = arm[1] * z - arm[2] * y, arm[2] * x - arm[0] * z, arm[0] * y - arm[1] * x
            place = p * axes.shape[0] + k
            for c in range(jacobian.shape[1]):
                out[place, c] = (
                    x * jacobian[0, c]
                    + y * jacobian[1, c]
                    + z * jacobian[2, c]
                    + u * jacobian[3, c]
                    + v * jacobian[4, c]
                    + w * jacobian[5, c]
                )


@numba.njit(cache=True)
def write_frame_motion(
    jacobian: Array, velocity: Array, drift: Array, rate: float, out: Array, target: Array
) -> None:  # pragma: no cover
    """Write the six rows of a frame and the accelerations that keep it still."""
    for r in range(6):
        out[r] = jacobian[r]
        target[r] = -drift[r] - rate * velocity[r]


@numba.njit(cache=True)
def write_point_motion(
    rotation: Array,
    velocity: Array,
    drift: Array,
    points: Array,
    axes: Array,
    rate: float,
    target: Array,
) -> None:  # pragma: no cover
    """Write the accelerations (p * a,) that keep points still, -dJ/dt v - rate * velocity.

    velocity and drift (6,) of the frame's origin; the others as in `write_force_map`.
    """
    arm, turn = np.empty(3), np.empty(3)
    for p in range(points.shape[0]):
        _turned(rotation, points[p], arm)
        # A point at arm r has the velocity v + w x r and the drift a + b x r + w x (w x r).
        _cross(velocity[3:], arm, turn)
        for k in range(axes.shape[0]):
            x, y, z = axes[k, 0], axes[k, 1], axes[k, 2]
            u, v, w = arm[1] * z - arm[2] * y, arm[2] * x - arm[0] * z, arm[0] * y - arm[1] * x
            still = _along(x, y, z, u, v, w, drift) + rate * _along(x, y, z, u, v, w, velocity)
            # axis . (w x turn) = w . (turn x axis)
            still += velocity[3] * (turn[1] * z - turn[2] * y)
            still += velocity[4] * (turn[2] * x - turn[0] * z)
            still += velocity[5] * (turn[0] * y - turn[1] * x)
            target[p * axes.shape[0] + k] = -still


@numba.njit(cache=True)
def force_limits(
    lower: Array, upper: Array, places: NDArray[np.intp]
) -> tuple[Array, Array]:  # pragma: no cover
    """Bounds (k,) [N] on the normal forces of the contacts at `places`.

    lower and upper (c,) [N] of all contacts; an upper one below zero means no force, and a lower
    one gives way to it.
    """
    low, high = np.empty(places.shape[0]), np.empty(places.shape[0])
    for k in range(places.shape[0]):
        high[k] = max(upper[places[k]], 0.0)
        low[k] = min(lower[places[k]], high[k])
    return low, high


@numba.njit(cache=True)
def write_force_cost(
    base: float,
    share: float,
    least: float,
    task: float,
    reference: float,
    normal: Array,
    last: Array,
    begin: int,
    center: Array,
    factor: Array,
) -> None:  # pragma: no cover
    """Cost on the forces of one contact, with the letters of ForceCost.

    base |f|^2 + share (|u - r F|^2 / F_0 + 2 r^T u - |r|^2 F) + task (F - reference)^2, halved;
    normal (c,) is e of F = e^T f; last (c,) [N] gives r and F_0, which is at least `least`.

    Writes, from entry `begin` on:
        center: [N] forces of the least cost; factor: F with F F^T = H^-1.
    """
    c = last.shape[0]
    points, load = 0.0, 0.0
    for i in range(c):
        points += normal[i] ** 2
        load += normal[i] * last[i]
    ratio, square = np.empty(c), 0.0  # r and |r|^2
    held = max(load, least)
    for i in range(c):
        ratio[i] = (last[i] - normal[i] * load / points) / held
        square += ratio[i] ** 2
    scale = share / held
    hessian, pull = np.zeros((c, c)), np.empty(c)
    for i in range(c):
        hessian[i, i] = base + scale
        pull[i] = -share * ratio[i]
    for i in range(c):
        for j in range(c):
            hessian[i, j] -= scale * ratio[i] * normal[j]
            hessian[j, i] -= scale * ratio[i] * normal[j]
    for i in range(c):
        pull[i] += normal[i] * (0.5 * share * square + task * reference)
        for j in range(c):
            hessian[i, j] += normal[i] * normal[j] * (scale * (square - 1.0 / points) + task)
    inverse = inverse_factor(hessian)
    for i in range(c):
        center[begin + i] = 0.0
        for j in range(c):
            factor[begin + i, begin + j] = inverse[i, j]
    for k in range(c):
        along = 0.0
        for i in range(c):
            along += inverse[i, k] * pull[i]
        for i in range(c):
            center[begin + i] += inverse[i, k] * along


@numba.njit(cache=True)
def _turned(rotation: Array, point: Array, out: Array) -> None:  # pragma: no cover
    for i in range(3):
        out[i] = 0.0
        for j in range(3):
            out[i] += rotation[i, j] * point[j]


@numba.njit(cache=True)
def _cross(left: Array, right: Array, out: Array) -> None:  # pragma: no cover
    out[0] = left[1] * right[2] - left[2] * right[1]
    out[1] = left[2] * right[0] - left[0] * right[2]
    out[2] = left[0] * right[1] - left[1] * right[0]


@numba.njit(cache=True)
def _along(
    x: float, y: float, z: float, u: float, v: float, w: float, motion: Array
) -> float:  # pragma: no cover
    """A spatial vector (6,) along an axis (x, y, z) with moment (u, v, w)."""
    linear = x * motion[0] + y * motion[1] + z * motion[2]
    return linear + u * motion[3] + v * motion[4] + w * motion[5]
