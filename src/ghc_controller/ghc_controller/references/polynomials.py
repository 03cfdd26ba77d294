"""Polynomials through points: linear, cubic or quintic, by the number of given derivatives."""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array


def hermite_coefficients(
    durations: Array,
    position: Array,
    velocity: tuple[Array, Array] | None = None,
    acceleration: tuple[Array, Array] | None = None,
) -> Array:
    """Coefficients of p(s) = sum_k c_k s^k on s in [0, duration], one polynomial a segment.

    Args:
        durations: (r,) > 0 [s].
        position: (r, 2, m) values at both ends of the segments.
        velocity, acceleration: ((r, m) at the start, (r, m) at the end). Without both the result
            is linear, with velocity alone cubic (C1), with both quintic (C2).

    Returns:
        (r, 6, m), zero above the degree.
    """
    start, end = position[:, 0], position[:, 1]
    result = np.zeros((len(durations), 6, position.shape[2]))
    result[:, 0] = start
    t = durations[:, None]
    if velocity is None:
        result[:, 1] = (end - start) / t
        return result
    v0, v1 = velocity
    result[:, 1] = v0
    if acceleration is None:
        step = end - start - v0 * t
        turn = (v1 - v0) * t
        result[:, 2] = (3.0 * step - turn) / t**2
        result[:, 3] = (turn - 2.0 * step) / t**3
        return result
    a0, a1 = acceleration
    result[:, 2] = 0.5 * a0
    step = end - start - v0 * t - 0.5 * a0 * t**2
    turn = (v1 - v0 - a0 * t) * t
    bend = (a1 - a0) * t**2
    result[:, 3] = (10.0 * step - 4.0 * turn + 0.5 * bend) / t**3
    result[:, 4] = (-15.0 * step + 7.0 * turn - bend) / t**4
    result[:, 5] = (6.0 * step - 3.0 * turn + 0.5 * bend) / t**5
    return result
