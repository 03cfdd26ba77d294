"""Speed of the machine during measurements, and CPU time stolen by its host."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

import numpy as np

_TURNS = 3000  # of a loop in plain Python, some 0.2 ms


class TakenByHost:
    """Fraction of the CPU time that the host of a virtual machine gave to others."""

    def __init__(self) -> None:
        self._begin = _cpu_times()

    def share(self) -> float:
        """Since construction; 0 if not available."""
        taken, total = (now - then for now, then in zip(_cpu_times(), self._begin, strict=True))
        return taken / total if total > 0.0 else 0.0


def _cpu_times() -> tuple[float, float]:
    """Stolen time, and all time, of all CPUs since the start of the system, in ticks."""
    try:
        first = Path("/proc/stat").read_text(encoding="ascii").splitlines()[0]
    except OSError:
        return 0.0, 0.0
    times = [float(value) for value in first.split()[1:9]]
    return times[7], sum(times)


class Pace:
    """Times a fixed workload repeatedly between the measurements."""

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
