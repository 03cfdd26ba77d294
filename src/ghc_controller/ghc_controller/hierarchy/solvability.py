"""Which priority matrices a schedule accepts: those with a unique solution."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array

_RAMP_SAMPLES = 9  # matrices checked along a requested ramp, including its target


class Solvability(NamedTuple):
    """A measure of matrices (k, k) at the current configuration, and its lower bound.

    It is negative beyond a singularity, so that a ramp that crosses one between two samples is
    also detected.
    """

    measure: Callable[[Array], float]  # [-]
    least: float = 1e-3
    meaning: str = (
        "the equation of motion (13b) would be unsolvable: smallest singular value of [P_1 .. P_k]"
    )
    advice: str = "leave one task that no other restricts (a row of zeros)"
    along_ramp: bool = True  # False: matrices between start and target are never solved

    def check(self, start: Array, target: Array, tasks: tuple[str, ...]) -> float:
        """Smallest measure from `start` (already active) to `target`.

        Raises:
            InvalidValue: it falls below `least`, or no task is left.
        """
        if (np.diag(target) >= 1.0).all():
            raise InvalidValue(
                "no task is left: all alpha_ii of the target are 1; at least one task expected of "
                + ", ".join(tasks)
            )
        count = _RAMP_SAMPLES if self.along_ramp else 1
        shares = [(sample + 1) / count for sample in range(count)]
        smallest = min(self.measure(start + share * (target - start)) for share in shares)
        if not smallest >= self.least:
            raise InvalidValue(
                f"{self.meaning} {smallest:.1e} on the ramp, at least {self.least:.0e} expected; "
                f"{self.advice} among {', '.join(tasks)}"
            )
        return smallest
