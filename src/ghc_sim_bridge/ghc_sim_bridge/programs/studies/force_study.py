"""One run of section 5.2: the maximum force drops to zero at 4 s and rises again at 6 s."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.types import Array
from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundWeights
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule

DROP, RISE, END = 4.0, 6.0, 10.0  # [s]
STARTED = 1e-2  # [-] of the jump: change of a bound that counts as its start


@dataclass(frozen=True, slots=True)
class ForceCase:
    """Parameters of the study; the defaults are those of figure 5.3."""

    jump: float = 5.0  # [N]
    weight: float = 0.1  # [s^2] alpha
    horizon: float = 1.5  # [s]
    step: float = 0.01  # [s]


@dataclass(frozen=True, slots=True)
class ForceRun:
    """Result of a run."""

    case: ForceCase
    time: Array  # (k,) [s]
    raw: Array  # (k,) [N]
    upper: Array  # (k,) [N]

    @property
    def largest_rate(self) -> float:
        """Largest derivative of the bound [N/s]."""
        return float(np.abs(np.diff(self.upper)).max() / self.case.step)

    @property
    def error(self) -> float:
        """Approximation error E of eq. 5.9 [N]."""
        return float((self.raw - self.upper).sum())

    @property
    def starts_at(self) -> float:
        """Time [s] at which the bound has changed by a hundredth of the jump."""
        moved = self.upper < self.raw - STARTED * self.case.jump
        return float(self.time[int(np.argmax(moved))])


def run_force(case: ForceCase) -> ForceRun:
    """Run the generator over the schedule."""
    generator = ContactForceBounds(
        ForceBoundSettings(
            step=case.step,
            horizon=case.horizon,
            weights=ForceBoundWeights(case.weight, case.weight),
        )
    )
    schedule = ContactSchedule.checked(
        "contact", [0.0, DROP, RISE], [0.0] * 3, [case.jump, 0.0, case.jump]
    )
    generator.observe(schedule, 0.0)
    time = _times(case.step)
    upper = np.array([generator.tick(now).upper[0, 0] for now in time])
    raw = np.array([schedule.at(now + 1e-9)[1] for now in time])
    return ForceRun(case, time, raw, upper)


def run_both_bounds() -> tuple[Array, Array, Array]:
    """Figure 5.4: both bounds of a contact that jump; time (k,), raw (k, 2), smooth (k, 2)."""
    generator = ContactForceBounds(ForceBoundSettings())
    schedule = ContactSchedule.checked(
        "contact", [0.0, 2.0, 4.0, 6.0, 8.0], [0, 1, 0, 0, 2], [5, 5, 0, 5, 3]
    )
    generator.observe(schedule, 0.0)
    time = _times(generator.settings.step)
    plans = [generator.tick(now) for now in time]
    smooth = np.array([[plan.lower[0, 0], plan.upper[0, 0]] for plan in plans])
    return time, np.array([schedule.at(now + 1e-9) for now in time]), smooth


def _times(step: float) -> Array:
    return step * np.arange(round(END / step), dtype=np.float64)


def linearity(runs: Sequence[ForceRun]) -> float:
    """R^2 of a straight line through largest derivative against jump."""
    jumps = np.array([run.case.jump for run in runs])
    rates = np.array([run.largest_rate for run in runs])
    rest = rates - np.polyval(np.polyfit(jumps, rates, 1), jumps)
    return float(1.0 - (rest @ rest) / ((rates - rates.mean()) @ (rates - rates.mean())))
