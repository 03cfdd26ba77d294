"""Memory of a process over simulated time, and its growth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ghc_controller as ghc

GROWTH_GOAL = 2.0  # [MB] after the warm-up, at most
_ENDS = 0.05  # share of the samples whose median stands for the start, and for the end
_KB = 1024.0 / 1e6  # [MB]


@dataclass(frozen=True, slots=True)
class MemoryCourse:
    """Resident memory of one node, sampled at equal steps of simulated time."""

    node: str
    times: Sequence[float]  # [s] simulated, increasing
    resident: Sequence[float]  # [MB]
    warm_up: float  # [s] what is before does not count
    plans: int  # answered ticks
    handled: int  # contacts or obstacles of a plan, at most

    def growth(self) -> float:
        """How much more [MB] at the end than after the warm-up, by medians of 5 % each."""
        values = self._after_warm_up()
        part = max(round(_ENDS * len(values)), 1)
        return float(np.median(values[-part:]) - np.median(values[:part]))

    def warm_memory(self) -> float:
        """Resident memory [MB] at the end of the warm-up."""
        return float(self._after_warm_up()[0])

    def summary(self) -> dict[str, object]:
        """Figures of the course; MB = 1e6 bytes."""
        values = self._after_warm_up()
        return {
            "node": self.node,
            "simulated_s": round(self.times[-1], 3),
            "warm_up_s": self.warm_up,
            "plans": self.plans,
            "handled": self.handled,
            "first_mb": round(self.resident[0], 3),
            "warm_mb": round(self.warm_memory(), 3),
            "last_mb": round(float(values[-1]), 3),
            "peak_mb": round(float(values.max()), 3),
            "growth_mb": round(self.growth(), 3),
            "goal_mb": GROWTH_GOAL,
            "met": self.growth() <= GROWTH_GOAL,
        }

    def _after_warm_up(self) -> np.ndarray:
        values = np.array(self.resident)[np.array(self.times) >= self.warm_up]
        if not len(values):
            raise ghc.GhcError(f"{self.node}: no sample after {self.warm_up:g} s of warm-up")
        return values


def resident_memory(pid: int) -> float:
    """Resident memory [MB] of a process, from /proc; GhcError when it does not say."""
    path = Path("/proc") / str(pid) / "status"
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        (line,) = (line for line in lines if line.startswith("VmRSS:"))
    except (OSError, ValueError) as error:
        raise ghc.GhcError(f"{path}: no resident memory to be read: {error}") from error
    return float(line.split()[1]) * _KB
