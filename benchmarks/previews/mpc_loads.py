"""Inputs for timing the generators: they jump, so that every tick has a change ahead.

Ten times a second something new comes: other schedules for all contacts, other places for all
obstacles. These ticks count apart from those between, which have the same change ahead of them
but have seen it before.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from ghc_controller.previews.preview import Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_mpc_constraints import (
    ContactForceBounds,
    ContactSchedule,
    ForceBoundSettings,
    Measurement,
    ObstacleBounds,
    ObstacleSettings,
)
from ghc_mpc_constraints.obstacle_motion.approach import ReactionTime

STEP = 0.01  # [s] T
CHANGE_EVERY = 10  # ticks: a sensor of 10 Hz, a planner as quick
_JUMP_EVERY = 0.4  # [s] of a schedule: the shortest horizon always holds one
_PHASE = 0.08  # [-] of that: how much later the jumps of the next contact come
_SAFE_DISTANCE = 0.4  # [m]
_LEAST_MOVE = 1e-6  # [N] of a bound, [m/s^3] of jerk: more than rounding


class Load(ABC):
    """One generator with its inputs; a new one starts at tick 0."""

    generator: str  # name of the node
    noun: str  # what it handles, in the plural

    def __init__(self, count: int, horizon: float) -> None:
        """`count` contacts or obstacles, a horizon N T [s]."""
        self.count = count
        self.horizon = horizon
        self._rng = np.random.default_rng(count)

    @abstractmethod
    def change(self, now: float) -> None:
        """Give the generator new inputs at `now` [s]."""

    @abstractmethod
    def tick(self, now: float) -> Any:
        """The plan of a tick; only this is timed."""

    @abstractmethod
    def moves(self, plan: Any) -> bool:
        """Whether everything in the plan is smoothed and changes within it."""

    @property
    @abstractmethod
    def second_opinions(self) -> int:
        """Number of structured solves repeated by the fallback solver."""


class ForceLoad(Load):
    """Contacts whose both bounds jump every 0.4 s, each at times of its own."""

    generator = "contact_force_bounds"
    noun = "contacts"

    def __init__(self, count: int, horizon: float) -> None:
        """See Load."""
        super().__init__(count, horizon)
        self._generator = ContactForceBounds(ForceBoundSettings(step=STEP, horizon=horizon))

    def change(self, now: float) -> None:
        """See Load; the times of the jumps stay, their heights are drawn anew."""
        jumps = int((self.horizon + CHANGE_EVERY * STEP) / _JUMP_EVERY) + 2
        for i in range(self.count):
            first = math.floor(now / _JUMP_EVERY - _PHASE * i + 1e-6) + 1
            times = [now, *((first + j + _PHASE * i) * _JUMP_EVERY for j in range(jumps))]
            lower = self._rng.uniform(0.0, 10.0, len(times)).tolist()
            upper = self._rng.uniform(20.0, 60.0, len(times)).tolist()
            schedule = ContactSchedule.checked(f"contact_{i}", times, lower, upper)
            self._generator.observe(schedule, now)

    def tick(self, now: float) -> Preview:
        """See Load."""
        return self._generator.tick(now)

    def moves(self, plan: Preview) -> bool:
        """See Load."""
        smoothed = all(status is PreviewStatus.SMOOTHED for status in plan.status)
        changes = (np.ptp(plan.upper, axis=1) > _LEAST_MOVE).all()
        return smoothed and len(plan.rows) == self.count and bool(changes)

    @property
    def second_opinions(self) -> int:
        """See Load."""
        return self._generator.second_opinions


class MotionLoad(Load):
    """Obstacles that jump about within their safe distance, along all axes."""

    generator = "obstacle_bounds"
    noun = "obstacles"

    def __init__(self, count: int, horizon: float) -> None:
        """See Load."""
        super().__init__(count, horizon)
        reaction = ReactionTime(max_velocity=0.5, shortest=0.3)  # inside the shortest horizon
        self._generator = ObstacleBounds(
            ObstacleSettings(step=STEP, horizon=horizon, reaction=reaction)
        )

    def change(self, now: float) -> None:
        """See Load."""
        seen = []
        for i in range(self.count):
            distance, aside = self._rng.uniform(0.2, 0.35), self._rng.uniform(-0.05, 0.05, 2)
            position, normal = [distance, *aside.tolist()], [-1.0, 0.0, 0.0]
            seen.append(
                Measurement.checked(
                    f"obstacle_{i}", "tool", position, normal, distance, _SAFE_DISTANCE
                )
            )
        self._generator.observe(seen, now)

    def tick(self, now: float) -> Preview:
        """See Load."""
        return self._generator.tick(now)

    def moves(self, plan: Preview) -> bool:
        """See Load."""
        return len(plan.motions) == self.count and all(
            planned.status is PreviewStatus.SMOOTHED
            and float(np.abs(planned.jerk).max()) > _LEAST_MOVE
            for planned in plan.motions
        )

    @property
    def second_opinions(self) -> int:
        """See Load."""
        return self._generator.second_opinions


LOADS: tuple[type[Load], ...] = (ForceLoad, MotionLoad)
