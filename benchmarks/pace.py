"""How fast the machine ran while it was measured on: its host may be shared as well."""

from __future__ import annotations

from time import perf_counter

import numpy as np

_TURNS = 3000  # of a loop in plain Python, some 0.2 ms


class Pace:
    """Times one fixed piece of work again and again, between the measurements."""

    def __init__(self) -> None:
        self._times: list[float] = []

    def take(self) -> None:
        """Time the work once more."""
        start = perf_counter()
        total = 0
        for turn in range(_TURNS):
            total += turn * turn
        self._times.append(perf_counter() - start)

    def summary(self) -> dict[str, float]:
        """Fastest and median time [us], and the share of the best speed at the median."""
        best, median = np.percentile(self._times, [1.0, 50.0]) * 1e6
        return {
            "best_us": round(float(best), 1),
            "median_us": round(float(median), 1),
            "share": round(float(best / median), 2),
        }
