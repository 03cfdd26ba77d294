"""Trust region with a radius per joint that shrinks where a joint oscillates (section V)."""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array

_FACTOR = 1.2  # rho_inc = rho_dec
_SMALLEST = 1e6  # eta_max


class TrustRegion:
    """Radii Delta / eta_i of the n coordinates.

    alpha_i is kept at 1 or more. As printed in the paper it has no lower bound: a first change of
    sign after 1000 steps without one would give 1.2^(-1000), an unbounded radius.
    """

    def __init__(self, n: int, radius: float, adapts: bool) -> None:
        self._radius, self._adapts = radius, adapts
        self._eta, self._alpha = np.ones(n), np.ones(n)
        self._sign: Array | None = None

    @property
    def radii(self) -> Array:
        """(n,) [rad], [m] largest |dq_i| of the next step."""
        return self._radius / self._eta

    def observe(self, step: Array) -> None:
        """Adapt to the last step (n,)."""
        sign = np.sign(step)
        if self._adapts and self._sign is not None:
            turned = sign != self._sign
            shrunk = np.minimum(_SMALLEST, _FACTOR**self._alpha * self._eta)
            self._eta = np.where(turned, shrunk, np.maximum(1.0, self._eta / _FACTOR))
            self._alpha = np.where(turned, self._alpha + 1.0, np.maximum(1.0, self._alpha - 1.0))
        self._sign = sign
