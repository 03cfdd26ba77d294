"""QP contact forces of a run, next to the simulated ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ghc_controller.types import Array
from ghc_sim_bridge.logs.full_rate_log import FullRateLog

CARRIES = 5.0  # [N] of normal force: below it the simulated share of friction says little
_SAME_TIME = 1e-6  # [s]


@dataclass(frozen=True, slots=True)
class ContactSurface:
    """What a load is measured against."""

    normal: Array  # (3,) unit, as the surroundings push; world axes
    friction: float  # [-] that the controller counts on; 0 = none


@dataclass(frozen=True, slots=True)
class LoadFigures:
    """One contact over the reports in which it was on."""

    share_of_time_on: float  # [-]
    asked_n: tuple[float, float]  # [N] smallest and largest normal force of the QP
    simulated_n: tuple[float, float]  # [N] of the simulation at the same times
    difference_rms_n: float  # [N] simulated - asked
    difference_largest_n: float  # [N]
    friction_use_qp: float  # [-] largest |F_t| / (mu F_n) of a point in the QP
    friction_use_simulated: float  # [-] of the whole contact, with the controller's mu


class LoadTrace:
    """Collects the contacts of `controller_state`."""

    def __init__(self) -> None:
        self._reports = 0
        self._loads: dict[str, list[tuple[float, float, float]]] = {}

    def append(self, time: float, state: Any) -> None:
        """Add one ControllerState at `time` [s]."""
        self._reports += 1
        for contact in state.contacts:
            if contact.on:
                load = (time, contact.force, contact.friction_use)
                self._loads.setdefault(contact.name, []).append(load)

    def figures(
        self, log: FullRateLog, surfaces: Mapping[str, ContactSurface]
    ) -> dict[str, LoadFigures]:
        """Figures of every contact that was ever on and whose wrench is in the log."""
        return {
            name: load_figures(log, log.wrenches[name], surfaces[name], loads, self._reports)
            for name, loads in self._loads.items()
            if name in log.wrenches and name in surfaces
        }


def load_figures(
    log: FullRateLog,
    wrench: Array,
    surface: ContactSurface,
    loads: Sequence[tuple[float, float, float]],
    reports: int,
) -> LoadFigures:
    """Figures of a contact: `wrench` (T, 6) at the log's times, `loads` = (time, F_n, use).

    The force asked for at t acts over the period that follows, and is sensed at its end.
    """
    time, asked, use = np.array(loads).T
    rows = np.minimum(np.searchsorted(log.time, time - _SAME_TIME) + 1, len(log.time) - 1)
    force = wrench[rows, :3]
    normal = force @ surface.normal
    tangential = np.linalg.norm(force - np.outer(normal, surface.normal), axis=1)
    carrying = normal > CARRIES
    shares = tangential[carrying] / np.maximum(surface.friction * normal[carrying], 1e-12)
    difference = np.abs(normal - asked)
    return LoadFigures(
        share_of_time_on=len(time) / max(reports, 1),
        asked_n=(float(asked.min()), float(asked.max())),
        simulated_n=(float(normal.min()), float(normal.max())),
        difference_rms_n=float(np.sqrt(np.mean(difference**2))),
        difference_largest_n=float(difference.max()),
        friction_use_qp=float(use.max()),
        friction_use_simulated=float(shares.max(initial=0.0)) if surface.friction > 0.0 else 0.0,
    )
