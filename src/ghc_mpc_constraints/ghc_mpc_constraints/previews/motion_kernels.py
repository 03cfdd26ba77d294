"""Riccati recursion of the triple integrator, compiled and written out by component.

x+ = A x + B u with A = [[1, T, T^2/2], [0, 1, T], [0, 0, 1]], B = [T^3/6, T^2/2, T] (eq. 4.11),
cost d_j (position - r_j)^2 + gamma u_j^2. `factor` does what depends on D alone, `respond` is
then O(N) for any linear term: some microseconds each, where a dense solve takes milliseconds.
"""

from __future__ import annotations

import numba
import numpy as np

from ghc_controller.types import Array

COLUMNS = 4  # of a factor: feedback on position, velocity, acceleration, and 1 / curvature


@numba.njit(cache=True)
def factor(step: float, weights: Array, jerk_weight: float) -> Array:
    """(N, COLUMNS) feedback gains and inverse curvature of every step, last to first."""
    steps = weights.shape[0]
    factors = np.empty((steps, COLUMNS))
    b0, b1, b2, half = step**3 / 6.0, step**2 / 2.0, step, step**2 / 2.0
    v00, v01, v02, v11, v12, v22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # the value, symmetric
    for j in range(steps - 1, -1, -1):
        v00 += weights[j]
        w0 = v00 * b0 + v01 * b1 + v02 * b2
        w1 = v01 * b0 + v11 * b1 + v12 * b2
        w2 = v02 * b0 + v12 * b1 + v22 * b2
        inverse = 1.0 / (jerk_weight + b0 * w0 + b1 * w1 + b2 * w2)
        c0, c1, c2 = w0, w0 * step + w1, w0 * half + w1 * step + w2  # B^T V A
        factors[j, 0], factors[j, 1] = c0 * inverse, c1 * inverse
        factors[j, 2], factors[j, 3] = c2 * inverse, inverse
        # V <- A^T V A - c c^T / curvature
        a01 = v00 * step + v01
        a02 = v00 * half + v01 * step + v02
        a11 = v01 * step + v11
        a12 = v01 * half + v11 * step + v12
        a22 = v02 * half + v12 * step + v22
        n11 = step * a01 + a11
        n12 = step * a02 + a12
        n22 = half * a02 + step * a12 + a22
        v00 -= c0 * c0 * inverse
        v01 = a01 - c0 * c1 * inverse
        v02 = a02 - c0 * c2 * inverse
        v11 = n11 - c1 * c1 * inverse
        v12 = n12 - c1 * c2 * inverse
        v22 = n22 - c2 * c2 * inverse
    return factors


@numba.njit(cache=True)
def respond(
    step: float, factors: Array, start: Array, linear: Array, positions: Array, jerk: Array
) -> None:
    """Optimal motion from `start` (3,) for the cost -linear^T x; the last two (N,) are written."""
    steps = linear.shape[0]
    b0, b1, b2, half = step**3 / 6.0, step**2 / 2.0, step, step**2 / 2.0
    p0, p1, p2 = 0.0, 0.0, 0.0  # the costate
    for j in range(steps - 1, -1, -1):
        p0 += linear[j]
        forward = b0 * p0 + b1 * p1 + b2 * p2
        jerk[j] = forward * factors[j, 3]
        q0, q1, q2 = p0, p0 * step + p1, p0 * half + p1 * step + p2  # A^T p
        p0 = q0 - factors[j, 0] * forward
        p1 = q1 - factors[j, 1] * forward
        p2 = q2 - factors[j, 2] * forward
    x0, x1, x2 = start[0], start[1], start[2]
    for j in range(steps):
        u = jerk[j] - (factors[j, 0] * x0 + factors[j, 1] * x1 + factors[j, 2] * x2)
        jerk[j] = u
        x0 += step * x1 + half * x2 + b0 * u
        x1 += step * x2 + b1 * u
        x2 += b2 * u
        positions[j] = x0
