"""Target streams of the study `reachable_targets`: curves, and the channel of their samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

import ghc_controller as ghc
from ghc_controller.reachable import JointLimitsOfMotion, ReachableSettings
from ghc_controller.reachable.target_stream import CONFIRMATIONS
from ghc_controller.types import Array, TaskTarget

Curve = Callable[[float], Array]  # time [s] -> position (3,) [m]

START = 0.5  # [s] first sample
_STANDS = 7.0  # [s] at the end of a random stream
_SPEED = 0.1  # [m/s] between jumps
_RADIUS = 0.08  # [m]
_OUT = 1.6  # [-] of the distance from the base: out of reach


@dataclass(frozen=True, slots=True)
class Channel:
    """How samples of a curve arrive: in order, delayed by abs(N(0, jitter)), some lost."""

    rate: float  # [Hz]
    jitter: float = 0.005  # [s]
    loss: float = 0.02  # [-]

    def samples(self, curve: Curve, end: float, seed: int) -> list[tuple[float, float, Array]]:
        """(arrival [s], stamp [s], position) until `end` [s]."""
        random = np.random.default_rng(seed)
        found: list[tuple[float, float, Array]] = []
        arrival = 0.0
        for k in range(int((end - START) * self.rate) + 1):
            stamp = START + k / self.rate
            lost, delay = random.random() < self.loss, abs(random.normal(0.0, self.jitter))
            if not lost:
                arrival = max(arrival + 1e-6, stamp + delay)
                found.append((arrival, stamp, curve(stamp)))
        return found


@dataclass(frozen=True, slots=True)
class RandomStream:
    """Slow circles about points that change by jumps, some out of reach; then it stands."""

    jumps: tuple[float, ...]  # [s]
    centers: tuple[Array, ...]  # (3,) [m]
    end: float  # [s]

    @classmethod
    def draw(
        cls, robot: ghc.Robot, task: ghc.Task, q: Array, seed: int, jumps: int
    ) -> RandomStream:
        """Points of random postures; every third is moved away from the base, out of reach."""
        random = np.random.default_rng(seed)
        model = robot.model
        centers = [position_at(robot, task, q)]
        times = [START]
        for k in range(jumps):
            spread = random.uniform(model.position_lower, model.position_upper)
            center = position_at(robot, task, q + 0.5 * (spread - q))
            centers.append(center * _OUT if (k + seed) % 3 == 2 else center)
            times.append(times[-1] + random.uniform(1.5, 2.5))
        return cls(tuple(times), tuple(centers), times[-1] + 1.5 + _STANDS)

    @property
    def stands_from(self) -> float:
        """[s] from which on it stands still."""
        return self.end - _STANDS

    def __call__(self, time: float) -> Array:
        """Position (3,) at a time [s]."""
        now = min(max(time, START), self.stands_from)
        return self.about(int(np.searchsorted(self.jumps, now, side="right")) - 1, now)

    def about(self, index: int, time: float) -> Array:
        """Position (3,) at a time [s] on the circle about one of its points."""
        since = time - self.jumps[index]
        angle = _SPEED / _RADIUS * (since - 0.5 * (1.0 - np.exp(-since / 0.5)))
        circle = np.array([np.cos(angle) - 1.0, np.sin(angle), 0.0])
        return self.centers[index] + _RADIUS * circle


@dataclass(frozen=True, slots=True)
class Conveyed:
    """What the samples of a random stream ask for, in continuous time.

    Until the first sample after a jump has come nothing tells of it: the circle before goes on.
    """

    stream: RandomStream
    known: tuple[float, ...]  # [s] when each jump was

    @classmethod
    def by(
        cls, stream: RandomStream, samples: list[tuple[float, float, Array]], grid: float
    ) -> Conveyed:
        """By samples (arrival, stamp, position) for a twin with a sample every `grid` [s].

        A jump beyond `largest_jump` counts once two more samples agree; the twin has them sooner.
        """
        known = []
        for k, jump in enumerate(stream.jumps):
            arrivals = [arrival for arrival, stamp, _ in samples if stamp >= jump]
            way = stream.about(k, jump) - stream.about(max(k - 1, 0), jump)
            far = float(np.linalg.norm(way)) > ReachableSettings().largest_jump
            waits = CONFIRMATIONS if far else 0
            known.append(grid * (np.ceil(arrivals[waits] / grid - 1e-6) - waits))
        return cls(stream, tuple(known))

    def __call__(self, time: float) -> Array:
        """Position (3,) at a time [s]."""
        now = min(max(time, self.known[0]), self.stream.stands_from)
        index = int(np.searchsorted(self.known, now + 1e-6, side="right")) - 1
        return self.stream.about(index, now)


def teleoperation_curve(center: Array) -> Curve:
    """A figure of eight across the arm, 0.13 m/s on average, after a start over 0.5 s."""

    def curve(time: float) -> Array:
        t = max(time - START, 0.0)
        p = 1.75 * (t - 0.5 * (1.0 - np.exp(-t / 0.5)))
        return center + np.array([0.0, 0.1 * np.sin(p), 0.025 * np.sin(2.0 * p)])

    return curve


def position_at(robot: ghc.Robot, task: ghc.Task, q: Array) -> Array:
    """Task variable (3,) at positions q (n,)."""
    robot.model.update(q, np.zeros(robot.model.nv))
    return task.current(robot.model).copy()


def least_distance(
    robot: ghc.Robot,
    task: ghc.Task,
    target: Array,
    limits: JointLimitsOfMotion,
    starts: list[Array],
) -> float:
    """[m] from a target to the nearest point within joint limits, from many starts."""
    model, still = robot.model, np.zeros(robot.model.nv)

    def rows(q: Array) -> tuple[Array, Array]:
        model.update(q, still)
        found = task.measured(model, TaskTarget(target, *np.zeros((2, 3))))
        return -found.error, found.jacobian

    inside = 1e-9 * (limits.upper - limits.lower)
    best = np.inf
    for q in starts:
        start = np.clip(q, limits.lower + inside, limits.upper - inside)
        found = least_squares(
            lambda q: rows(q)[0], start, lambda q: rows(q)[1], (limits.lower, limits.upper)
        )
        best = min(best, float(np.sqrt(2.0 * found.cost)))
    return best
