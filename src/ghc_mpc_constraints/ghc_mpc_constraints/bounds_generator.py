"""Base class of generators that smooth scheduled bounds: forces, torques, joint positions."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections import Counter
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ghc_controller.previews.preview import Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.types import Array
from ghc_mpc_constraints.generator import Generator
from ghc_mpc_constraints.previews.horizon import STEP_TOLERANCE, Horizon
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule
from ghc_mpc_constraints.schedules.raw_bounds import RawBounds, preview


class Bounds(NamedTuple):
    """Bounds of one row at the N + 1 points of a horizon."""

    lower: Array  # (N + 1,)
    upper: Array  # (N + 1,)


class BoundsGenerator(Generator):
    """Both bounds of every scheduled row over a receding horizon.

    The first input of a preview is applied: the next tick starts from the previous preview. A row
    starts at its raw bounds, or at those passed to `take_over`. Without a solution the previous
    preview is used to its end, then the bounds tighten towards the tightest upcoming raw bounds.
    A bound is never looser than the raw one.
    """

    TROUBLE = ("held", "tightened", "conflicts")

    def __init__(self, settings: Any) -> None:
        """Create the grid.

        Raises:
            InvalidValue: a horizon that is not a multiple of the step.
        """
        self.settings = settings
        self.horizon = Horizon.of(settings.step, settings.horizon)
        self.counts: Counter[str] = Counter()
        self._schedules: dict[str, LimitSchedule] = {}
        self._handed_over: dict[str, tuple[float, float]] = {}
        self._preview: Preview | None = None

    @abstractmethod
    def smooth(self, name: str, time: float, first: tuple[float, float], raw: RawBounds) -> Any:
        """Bounds (lower, upper) at the points 1 .. N, each (N,), from the first ones; or None.

        Args:
            name: of the row.
            time: [s] of the tick.
            first: lower and upper bound at point 0, inside the raw ones.
            raw: bounds that the result must satisfy.
        """

    def is_active(self, schedule: LimitSchedule, time: float) -> bool:  # noqa: ARG002
        """Whether the row is active at a time [s]."""
        return True

    def floor(self, raw: RawBounds) -> tuple[float, float]:
        """Lower and upper bound towards which a row without a solution tightens."""
        return float(raw.lower.max()), float(raw.upper.min())

    def observe(self, given: LimitSchedule, now: float) -> None:
        """Use a schedule from its first time on; the plan before that stays."""
        old = self._schedules.get(given.name)
        self._schedules[given.name] = given if old is None else old.followed_by(given, now)

    def take_over(self, in_force: Preview) -> None:
        """Start its rows from the current bounds instead of the raw ones."""
        for row, name in enumerate(in_force.rows):
            self.start_from(name, float(in_force.lower[row, 0]), float(in_force.upper[row, 0]))

    def start_from(self, name: str, lower: float, upper: float) -> None:
        """Start one row from current bounds; no effect on a row that is already planned."""
        if math.isfinite(lower) and math.isfinite(upper):
            self._handed_over[name] = (lower, upper)

    def hold_handed_over(self) -> None:
        """Keep a row that was taken over and has no schedule at its current bounds.

        Without this the preview would omit it, and the limits of the robot's file would apply at
        once. A later schedule continues from there.
        """
        for name, (lower, upper) in self._handed_over.items():
            if name not in self._schedules:
                self._schedules[name] = self.held(name, lower, upper)

    def held(self, name: str, lower: float, upper: float) -> LimitSchedule:
        """Schedule of a row that keeps its bounds."""
        return LimitSchedule.checked(name, [0.0], [lower], [upper])

    def reset(self) -> None:
        """Discard schedules, previews and current bounds: time restarts.

        Schedules have to be given again: merged ones have lost their past.
        """
        self._schedules.clear()
        self._preview = None
        self._handed_over.clear()

    def previews(self, time: float) -> tuple[Preview, ...]:
        """The preview of a tick; rows that were taken over and have no schedule are held."""
        self.hold_handed_over()
        return (self.tick(time),)

    def tick(self, time: float) -> Preview:
        """Plan from `time` [s]; called again for the same time, the start is the same."""
        rows = tuple(sorted(self._schedules))
        shape = (len(rows), self.horizon.steps + 1)
        lower, upper = np.empty(shape), np.empty(shape)
        on, status, conflict = [], [], []
        for i, name in enumerate(rows):
            schedule = self._schedules[name]
            raw = preview(schedule, time, self.horizon)
            on.append(self.is_active(schedule, time + STEP_TOLERANCE * self.horizon.step))
            conflict.append(raw.conflict)
            status.append(self._plan_row(name, time, raw, Bounds(lower[i], upper[i])))
            self.counts["conflicts"] += raw.conflict
            self.counts[status[-1].name.lower()] += 1
        smoothing = bool(self.settings.smoothing)
        ends = (tuple(on), tuple(status), tuple(conflict), smoothing)
        self._preview = Preview(self.kind, time, self.horizon.step, rows, lower, upper, *ends)
        return self._preview

    def _plan_row(self, name: str, time: float, raw: RawBounds, out: Bounds) -> PreviewStatus:
        """Plan the bounds of one row."""
        lower, upper = out
        if not self.settings.smoothing:
            lower[:], upper[:] = raw.lower, raw.upper
            return PreviewStatus.RAW
        start = self._in_force(name, time)
        lower[0], upper[0] = raw.lower[0], raw.upper[0]
        if start is not None:  # a late change can put it outside the raw bounds
            upper[0] = min(max(start[1], raw.lower[0]), raw.upper[0])
            lower[0] = min(max(start[0], raw.lower[0]), upper[0])
        answer = self.smooth(name, time, (lower[0], upper[0]), raw)
        if answer is not None:
            lower[1:], upper[1:] = answer
            return PreviewStatus.SMOOTHED
        return self._without_solution(name, time, raw, out)

    def _in_force(self, name: str, time: float) -> Sequence[float] | None:
        """Bounds of the previous preview at `time`, or those passed to `take_over`."""
        before = self._preview
        if before is None or name not in before.rows:
            return self._handed_over.get(name)
        lower, upper = before.at(time)
        index = before.rows.index(name)
        return float(lower[index]), float(upper[index])

    def _without_solution(
        self, name: str, time: float, raw: RawBounds, out: Bounds
    ) -> PreviewStatus:
        lower, upper = out
        before = self._preview
        held = before is not None and name in before.rows and time < before.valid_until
        if held and before is not None:
            index = before.rows.index(name)
            for j, moment in enumerate(self.horizon.times(time)[1:], start=1):
                values = before.at(moment)
                lower[j], upper[j] = values[0][index], values[1][index]
        else:
            ramp = self.settings.tighten_rate * self.horizon.step * np.arange(len(lower))
            least, most = self.floor(raw)
            upper[:] = np.maximum(upper[0] - ramp, min(most, upper[0]))
            lower[:] = np.minimum(lower[0] + ramp, max(least, lower[0]))
        upper[:] = np.minimum(np.maximum(upper, raw.lower), raw.upper)
        lower[:] = np.minimum(np.maximum(lower, raw.lower), upper)
        return PreviewStatus.HELD if held else PreviewStatus.TIGHTENED
