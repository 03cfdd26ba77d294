"""Time per control step against the number of tasks, every formulation in one run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.robots import BenchRobot
from benchmarks.states import Segment, closed_loop, random_goals, torque_bound
from benchmarks.timed_controller import TimedController, Variant, make_controller
from ghc_controller.types import Array

VARIANTS = (
    Variant("ghc_full", "daqp"),
    Variant("ghc", "daqp"),
    Variant("balanced", "daqp"),
    Variant("hqp", "daqp"),
    Variant("weighted", "daqp"),
    Variant("ghc_full", "proxqp"),
    Variant("ghc", "proxqp"),
)
REGIMES = ("inactive", "active")  # no bound is reached; torque bounds are
_DRIVER = Variant("balanced", "daqp")  # makes the states that all variants are timed in


@dataclass(frozen=True, slots=True)
class Effort:
    """How much is measured for each robot, number of tasks and regime."""

    segments: int
    length: int  # states of a segment
    rounds: int  # how often every segment is gone through

    @property
    def steps(self) -> int:
        """Timed steps of each variant."""
        return self.segments * self.length * self.rounds


FULL = Effort(segments=8, length=40, rounds=3)
QUICK = Effort(segments=2, length=10, rounds=1)


def run_step_bench(
    robots: Sequence[BenchRobot], effort: Effort, tell: Callable[[str], None]
) -> Iterator[dict[str, Any]]:
    """One row per robot, number of tasks, regime and variant; `tell` hears of the progress."""
    for robot in robots:
        for count in range(1, robot.most_tasks + 1):
            tell(f"{robot.title}, {count} task{'s' if count > 1 else ''}")
            yield from _case(robot, count, effort)


def _case(robot: BenchRobot, count: int, effort: Effort) -> Iterator[dict[str, Any]]:
    config = robot.config(count)
    start = robot.start(config.model)
    rng = np.random.default_rng(count)
    goals = random_goals(config, start, rng, effort.segments)
    free = closed_loop(make_controller(config, _DRIVER, None), start, goals, effort.length)
    bound = torque_bound(make_controller(config, _DRIVER, None), free)
    bounded = closed_loop(make_controller(config, _DRIVER, bound), start, goals, effort.length)
    rows = sum(task.size for task in config.tasks)
    for regime, segments, limit in (("inactive", free, None), ("active", bounded, bound)):
        for summary in _measure(robot, count, segments, limit, effort.rounds, rng):
            yield {
                "robot": robot.name,
                "dof": config.model.nv,
                "tasks": count,
                "rows": rows,
                "regime": regime,
                **summary,
            }


def _measure(
    robot: BenchRobot,
    count: int,
    segments: Sequence[Segment],
    bound: Array | None,
    rounds: int,
    rng: np.random.Generator,
) -> list[dict[str, Any]]:
    """All variants, segment by segment in random order, so that noise hits all alike."""
    timed = [TimedController(robot.config(count), variant, bound) for variant in VARIANTS]
    for controller in timed:
        for segment in segments:
            controller.watch(segment)
    for _ in range(rounds):
        for segment in segments:
            for index in rng.permutation(len(timed)):
                timed[index].follow(segment)
    return [controller.summary() for controller in timed]
