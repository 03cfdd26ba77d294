"""QP contact forces of a run compared with the simulated ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ghc_controller.types import Array
from ghc_sim_bridge.logs.full_rate_log import FullRateLog

CARRIES = 5.0  # [N] normal force below which the simulated friction ratio is meaningless
_SAME_TIME = 1e-6  # [s]


@dataclass(frozen=True, slots=True)
class ContactSurface:
    """Normal and friction of a contact."""

    normal: Array  # (3,) unit, direction of the force on the robot; world axes
    friction: float  # [-] coefficient assumed by the controller; 0 = none


@dataclass(frozen=True, slots=True)
class LoadFigures:
    """Statistics of one contact over the samples in which it was active."""

    share_of_time_on: float  # [-]
    asked_n: tuple[float, float]  # [N] smallest and largest normal force of the QP
    simulated_n: tuple[float, float]  # [N] of the simulation at the same times
    difference_rms_n: float  # [N] simulated - asked
    difference_largest_n: float  # [N]
    friction_use_qp: float  # [-] largest |F_t| / (mu F_n) of a point in the QP
    friction_use_simulated: float  # [-] of the whole contact, with the controller's mu


class LoadTrace:
    """Collects contacts from `controller_state` messages."""

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
        """Statistics of every contact that was active and whose wrench was logged."""
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
    """Statistics of a contact: `wrench` (T, 6) at the log's times, `loads` = (time, F_n, use).

    The force commanded at t acts over the next period and is measured at its end.
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
