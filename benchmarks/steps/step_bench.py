"""Time per control step against the number of tasks, every formulation in one run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.steps.pace import Pace
from benchmarks.steps.robots import BenchRobot
from benchmarks.steps.states import Segment, closed_loop, random_goals, torque_bound
from benchmarks.steps.timed_controller import TimedController, Variant, make_controller

_DEFAULT = ghc.Settings().formulation

VARIANTS = (
    Variant("cascade", "daqp"),
    Variant("ghc_full", "daqp"),
    Variant("ghc", "daqp"),
    Variant("balanced", "daqp"),
    Variant("hqp", "daqp"),
    Variant("weighted", "daqp"),
    Variant("ghc_full", "proxqp"),
    Variant("ghc", "proxqp"),
)
REGIMES = ("inactive", "active")  # no bound is reached; torque bounds are
_DRIVER = Variant(_DEFAULT, "daqp")  # makes the states that all variants are timed in


@dataclass(frozen=True, slots=True)
class Effort:
    """Number of measurements per robot, number of tasks and regime."""

    segments: int
    length: int  # states of a segment
    rounds: int  # how often every segment is gone through

    @property
    def steps(self) -> int:
        """Timed steps of each variant."""
        return self.segments * self.length * self.rounds


FULL = Effort(segments=8, length=30, rounds=4)
QUICK = Effort(segments=2, length=10, rounds=1)


@dataclass(frozen=True, slots=True)
class Case:
    """One number of tasks in one regime: where all variants are timed."""

    facts: dict[str, Any]
    segments: Sequence[Segment]
    timed: Sequence[TimedController]

    def follow(self, rng: np.random.Generator) -> None:
        """All variants, segment by segment in random order."""
        for segment in self.segments:
            for index in rng.permutation(len(self.timed)):
                self.timed[index].follow(segment)


def run_step_bench(
    robots: Sequence[BenchRobot], effort: Effort, pace: Pace, tell: Callable[[str], None]
) -> Iterator[dict[str, Any]]:
    """One row per robot, number of tasks, regime and variant; `tell` hears of the progress.

    The rounds go over all cases of a robot, so that a slow minute of the machine hits all alike.
    """
    for robot in robots:
        tell(f"{robot.title}: states in which to measure")
        cases: list[Case] = []
        for count in range(1, robot.most_tasks + 1):
            cases += _cases(robot, count, effort)
        rng = np.random.default_rng(0)
        for number in range(effort.rounds):
            tell(f"{robot.title}: round {number + 1} of {effort.rounds}")
            for index in rng.permutation(len(cases)):
                pace.take()
                cases[index].follow(rng)
        for case in cases:
            for timed in case.timed:
                yield case.facts | timed.summary()


def _cases(robot: BenchRobot, count: int, effort: Effort) -> Iterator[Case]:
    config = robot.config(count)
    start = robot.start(config.model)
    goals = random_goals(config, start, np.random.default_rng(count), effort.segments)
    free = closed_loop(make_controller(config, _DRIVER, None), start, goals, effort.length)
    bound = torque_bound(make_controller(config, _DRIVER, None), free)
    bounded = closed_loop(make_controller(config, _DRIVER, bound), start, goals, effort.length)
    for regime, segments, limit in zip(REGIMES, (free, bounded), (None, bound), strict=True):
        timed = [TimedController(robot.config(count), variant, limit) for variant in VARIANTS]
        for controller in timed:
            for segment in segments:
                controller.watch(segment)
        facts = {
            "robot": robot.name,
            "dof": config.model.nv,
            "tasks": count,
            "rows": sum(task.size for task in config.tasks),
            "regime": regime,
        }
        yield Case(facts, segments, timed)
