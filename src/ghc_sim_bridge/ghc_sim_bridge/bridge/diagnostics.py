"""Diagnostics of the bridge, once a second."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from ghc_controller.ros.rejections import Recent, Rejections
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.run_mode import RunMode

# Part of normal operation (answers to repeats, late answers while paused): counted without a #
# warning.
EXPECTED = frozenset({"answered_before", "not_running"})


@dataclass(frozen=True, slots=True)
class Health:
    """One line, whether it is a warning, and figures by name."""

    summary: str
    warning: bool
    values: Mapping[str, object]


class BridgeDiagnostics:
    """Counts of rejections and the pace of time since the last report."""

    def __init__(self, rejections: Rejections) -> None:
        """Report `rejections` and the values passed to `report`."""
        self._rejections = rejections
        self._recent = Recent()
        self._before = (time.monotonic(), 0)  # wall [s], simulated [ns]

    def report(self, cycle: ControlCycle, mode_name: str, mode: RunMode) -> Health:
        """Current health of the bridge."""
        wall, simulated = time.monotonic(), cycle.time_ns
        wall_before, simulated_before = self._before
        self._before = (wall, simulated)
        pace = (simulated - simulated_before) / NANOSECONDS / max(wall - wall_before, 1e-9)
        counts = self._rejections.counts
        refused = sum(count for field, count in counts.items() if field not in EXPECTED)
        values = {
            "mode": mode_name,
            "paused": mode.paused,
            "epoch": cycle.epoch,
            "simulated_time_s": simulated / NANOSECONDS,
            "real_time_factor": round(pace, 3),
            **mode.diagnostics(),
            **{f"rejected_{field}": count for field, count in sorted(counts.items())},
        }
        warning, summary = self._recent.told(refused, f"{refused} commands rejected or clipped")
        return Health(summary, warning, values)
