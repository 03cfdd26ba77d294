"""Diagonal of the weighting matrix D of eq. 4.15: weight of each point of the preview."""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array

POWER = 7.0  # [-] g of eq. 4.16 for a jerk weight of 1e-5: the lowest weight is 1e-7
_LAMBDA_SHARE = 9.0  # lambda as a fraction of the range: the lowest weight is 10^-g
_STILL = 1e-12  # [m] smaller motions of a preview are ignored


def dynamic_weights(raw: Array, power: float = POWER) -> Array:
    """d_j of eq. 4.16, (N,): one where the obstacle is closest (smallest), small elsewhere."""
    return _weights(raw - raw.min(), power)


def dynamic_weights_two_sided(raw: Array, power: float = POWER) -> Array:
    """As above, for an axis without a safer side: one where the preview ends."""
    return _weights(np.abs(raw - raw[-1]), power)


def _weights(excess: Array, power: float) -> Array:
    span = float(excess.max())
    if span < _STILL:
        return np.ones_like(excess)
    share = span / _LAMBDA_SHARE
    weights: Array = ((span - excess + share) / (span + share)) ** power
    return weights
