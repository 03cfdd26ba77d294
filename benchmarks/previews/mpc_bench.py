"""Time per tick of the generators, by horizon and number of contacts or obstacles."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter, thread_time
from typing import Any

import numpy as np

from benchmarks.previews.mpc_loads import CHANGE_EVERY, LOADS, STEP, Load
from benchmarks.steps.pace import Pace

HORIZONS = (0.5, 1.0, 1.5, 3.0)  # [s] N T
COUNTS = (1, 2, 4, 8)  # contacts or obstacles
# Ticks by what came before: all alike, new inputs, nothing at all.
KINDS = ("warm", "changed", "first")


@dataclass(frozen=True, slots=True)
class MpcEffort:
    """Number of measurements per generator, horizon and count."""

    rounds: int
    ticks: int  # of a round, a multiple of CHANGE_EVERY
    fresh: int  # generators made anew in a round


FULL = MpcEffort(rounds=10, ticks=100, fresh=4)
QUICK = MpcEffort(rounds=1, ticks=20, fresh=1)


class TimedLoad:
    """One case: the times [s] of its ticks."""

    def __init__(self, kind: type[Load], count: int, horizon: float) -> None:
        """Create the generator."""
        self._kind, self._count, self._horizon = kind, count, horizon
        self._load = kind(count, horizon)
        self._next = 0  # number of the next tick
        self._times: dict[str, list[float]] = {name: [] for name in (*KINDS, "start", "cpu")}
        self._moves: list[bool] = []
        self._tick(self._load, 0, None)  # the very first of a process is nobody's case
        self._next = 1

    def start_afresh(self) -> None:
        """Time the construction of a generator, and its first tick."""
        begun = perf_counter()
        fresh = self._kind(self._count, self._horizon)
        self._times["start"].append(perf_counter() - begun)
        self._tick(fresh, 0, "first")

    def follow(self, ticks: int) -> None:
        """Time consecutive ticks."""
        for number in range(self._next, self._next + ticks):
            self._tick(self._load, number, "warm" if number % CHANGE_EVERY else "changed")
        self._next += ticks

    def summary(self) -> dict[str, Any]:
        """The case and its times [us]."""
        return {
            "generator": self._load.generator,
            "handles": self._load.noun,
            "count": self._count,
            "horizon": self._horizon,
            "moving_share": round(float(np.mean(self._moves)), 3),
            "second_opinions": self._load.second_opinions,
            "start_us": _median(self._times["start"]),
            "warm_cpu_us": _median(self._times["cpu"]),
            "ticks_us": {
                kind: {
                    "ticks": len(self._times[kind]),
                    "median": _median(self._times[kind]),
                    "p99": round(float(np.percentile(self._times[kind], 99.0)) * 1e6, 1),
                }
                for kind in KINDS
            },
        }

    def _tick(self, load: Load, number: int, kind: str | None) -> None:
        """One tick; processing of inputs is not timed."""
        now = number * STEP
        if number % CHANGE_EVERY == 0:
            load.change(now)
        cpu_start, start = thread_time(), perf_counter()
        plan = load.tick(now)
        spent, cpu = perf_counter() - start, thread_time() - cpu_start
        if kind is None:
            return
        self._times[kind].append(spent)
        if kind == "warm":
            self._times["cpu"].append(cpu)
        self._moves.append(load.moves(plan))


def run_mpc_bench(
    effort: MpcEffort, pace: Pace, tell: Callable[[str], None]
) -> Iterator[dict[str, Any]]:
    """One row per generator, horizon and count; `tell` hears of the progress.

    The rounds go over all cases in random order, so that a slow minute of the machine hits all
    alike.
    """
    tell("generators: made")
    cases: Sequence[TimedLoad] = [
        TimedLoad(kind, count, horizon)
        for kind in LOADS
        for horizon in HORIZONS
        for count in COUNTS
    ]
    rng = np.random.default_rng(0)
    for number in range(effort.rounds):
        tell(f"generators: round {number + 1} of {effort.rounds}")
        for index in rng.permutation(len(cases)):
            pace.take()
            for _ in range(effort.fresh):
                cases[index].start_afresh()
            cases[index].follow(effort.ticks)
    for case in cases:
        yield case.summary()


def _median(times: Sequence[float]) -> float:
    return round(float(np.median(times)) * 1e6, 1)
