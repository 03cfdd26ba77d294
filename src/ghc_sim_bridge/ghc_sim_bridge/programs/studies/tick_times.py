"""Time per tick of both generators, by horizon and number of contacts or obstacles."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.generators.obstacle_motion import ObstacleBounds, ObstacleSettings
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule

Tick = Callable[[float], object]
Feed = Callable[[int], None]  # called before each tick with its number

TICKS = 400
STEP = 0.01  # [s]


@dataclass(frozen=True, slots=True)
class TickCase:
    """Generator, number of contacts or obstacles, horizon [s]."""

    generator: str  # contact_force_bounds | obstacle_bounds
    count: int
    horizon: float


@dataclass(frozen=True, slots=True)
class TickTimes:
    """Times [s], wall time unless stated otherwise."""

    case: TickCase
    start: float  # construction of the generator
    first: float  # the first tick
    median: float  # over ticks with a change in the horizon
    p99: float
    own: float  # median CPU time of the thread, independent of other load


def time_ticks(case: TickCase) -> TickTimes:
    """Time a generator over ticks with a change in every horizon."""
    begun = time.perf_counter()
    tick, feed = _force(case) if case.generator == "contact_force_bounds" else _motion(case)
    start = time.perf_counter() - begun
    spent = np.empty((TICKS, 2))
    for k in range(TICKS):
        feed(k)
        before = time.perf_counter(), time.thread_time()
        tick(k * STEP)
        spent[k] = np.array([time.perf_counter(), time.thread_time()]) - before
    wall, own = spent[1:].T
    return TickTimes(
        case,
        start,
        float(spent[0, 0]),
        float(np.median(wall)),
        float(np.quantile(wall, 0.99)),
        float(np.median(own)),
    )


def _force(case: TickCase) -> tuple[Tick, Feed]:
    """Contacts with both bounds jumping once per second, at different times."""
    generator = ContactForceBounds(ForceBoundSettings(step=STEP, horizon=case.horizon))
    for i in range(case.count):
        times = [0.0, *(np.arange(1, 2 * TICKS // 100) * 0.5 + 0.07 * i)]
        on = np.arange(len(times)) % 2 == 0
        generator.observe(
            ContactSchedule.checked(
                f"contact_{i}", times, (10.0 * on).tolist(), (60.0 * on).tolist()
            ),
            0.0,
        )
    return generator.tick, lambda _: None


def _motion(case: TickCase) -> tuple[Tick, Feed]:
    """Obstacles that jump randomly within their safe distance at 10 Hz, along all axes."""
    generator = ObstacleBounds(ObstacleSettings(step=STEP, horizon=case.horizon))
    rng = np.random.default_rng(0)

    def feed(k: int) -> None:
        if k % 10:
            return
        seen = []
        for i in range(case.count):
            distance, aside = rng.uniform(0.2, 0.35), rng.uniform(-0.05, 0.05, 2)
            seen.append(
                Measurement.checked(
                    f"obstacle_{i}", "tool", [distance, *aside], [-1.0, 0.0, 0.0], distance, 0.4
                )
            )
        generator.observe(seen, k * STEP)

    return generator.tick, feed
