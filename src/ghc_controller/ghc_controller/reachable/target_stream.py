"""The samples of one task: checked, estimated, and followed by a filter without steps."""

from __future__ import annotations

import math

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.reachable.arrival_clock import ArrivalClock
from ghc_controller.reachable.estimator import MotionEstimator
from ghc_controller.reachable.settings import ReachableSettings
from ghc_controller.reachable.tangent import difference, moved
from ghc_controller.references.follower import Follower, ReferenceSpace
from ghc_controller.types import Array

_AHEAD = 0.1  # [s] a stamp farther ahead of the robot's time belongs to another clock
_PER_SAMPLE = 0.7  # [-] most of the bandwidth times the mean interval of samples
_ANSWER = 10.0  # [-] times 1 / bandwidth after which the filter has answered a jump
CONFIRMATIONS = 2  # further samples near a first one that is far away


class TargetStream:
    """Parts of one target: a vector, a rotation, or both for a pose.

    Attributes:
        jumps: samples that restarted the estimate.
    """

    def __init__(self, task: Follower, settings: ReachableSettings) -> None:
        self.task, self._settings = task, settings
        self._rotations = {
            ReferenceSpace.VECTOR: (False,),
            ReferenceSpace.ORIENTATION: (True,),
            ReferenceSpace.POSE: (False, True),
        }[task.space]
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self.jumps = 0
        self._clock = ArrivalClock(self._settings.jitter)
        self._estimators: list[MotionEstimator] = []
        self._followed: list[tuple[Array, Array]] = []  # position, velocity of the filter
        self._answered = -math.inf  # [s] when the answer to the last jump ends
        self._far: list[tuple[float, list[Array]]] = []  # samples that wait for confirmation

    @property
    def has_begun(self) -> bool:
        """True after the first sample."""
        return bool(self._estimators)

    @property
    def time(self) -> float:
        """[s] of the last sample, -inf before the first one."""
        return self._estimators[0].time if self._estimators else -math.inf

    def begin(self, position: Array) -> None:
        """Let the filter start at rest at a task value, (position_size,)."""
        self._followed = [
            (part.copy(), np.zeros(3 if rotation else len(part)))
            for part, rotation in zip(self._parts(position), self._rotations, strict=True)
        ]

    def add(self, stamp: float | None, position: Array, now: float) -> None:
        """Take a sample.

        Args:
            stamp: [s] when the target was there, in the robot's time; None: estimated from the
            arrival times.
            position: as a reference position of the task.
            now: [s] time of the robot.

        Raises:
            WrongSize, InvalidValue: it does not fit the task, or its stamp or its distance from
                the sample before is rejected; the stream goes on without it.
        """
        value = self.task.static_target(position).position
        jitter = self._settings.jitter
        if stamp is None:
            stamp = self._clock.stamp(now)
            jitter *= self._clock.doubt
        self._check_stamp(stamp, now)
        parts = self._parts(value)
        if not self._estimators:
            for part, rotation in zip(parts, self._rotations, strict=True):
                self._estimators.append(MotionEstimator(stamp, part, rotation, self._settings))
            return
        self._check_distance(stamp, parts)
        dt = stamp - self._estimators[0].time
        reach = self._settings.jump + self._settings.speed * dt
        for part, estimator in zip(parts, self._estimators, strict=True):
            if np.linalg.norm(estimator.innovation(stamp, part)) > reach:
                estimator.restart(stamp, part)
                self.jumps += 1
            else:
                estimator.add(stamp, part, jitter)

    def follow(self, time: float, period: float) -> Array:
        """Position (position_size,) of the filter at `time` [s], `period` [s] after the last one.

        Critically damped towards a target that moves at its estimated acceleration: the error
        e = (e_0 + (e_0' + w e_0) t) exp(-w t), no lag at constant acceleration. Samples that come
        rarely lower w, except while a jump is answered.
        """
        if not self._estimators:
            return np.concatenate([position for position, _ in self._followed])
        w = self._bandwidth(time)
        rest = math.exp(-w * period)
        result = []
        for i, (estimator, rotation) in enumerate(
            zip(self._estimators, self._rotations, strict=True)
        ):
            position, velocity = self._followed[i]
            goal, rate, acceleration = estimator.at(time)
            earlier = rate - period * acceleration
            before = moved(goal, -0.5 * period * (rate + earlier), rotation)
            error = difference(position, before, rotation)
            if np.linalg.norm(error) > self._settings.jump:
                self._answered = time + _ANSWER / self._settings.bandwidth
            slope = (velocity - earlier) + w * error
            now = (error + slope * period) * rest
            change = slope * rest - w * now
            self._followed[i] = (moved(goal, now, rotation), rate + change)
            result.append(self._followed[i][0])
        return np.concatenate(result)

    def _bandwidth(self, time: float) -> float:
        """[1/s] at a time [s]: at most a share of the rate of samples, but not after a jump."""
        interval = self._estimators[0].interval
        if interval is None or time < self._answered:
            return self._settings.bandwidth
        return min(self._settings.bandwidth, _PER_SAMPLE / interval)

    def _check_stamp(self, stamp: float, now: float) -> None:
        name = f"target of '{self.task.name}', stamp"
        if stamp > now + _AHEAD:
            raise InvalidValue(
                f"{name}: {stamp:.3f} s given, at most {now + _AHEAD:.3f} s expected: the robot's "
                f"time is {now:.3f} s; leave the stamp zero where clocks differ"
            )
        if stamp < now - self._settings.stale_after:
            raise InvalidValue(
                f"{name}: {stamp:.3f} s given, {now - self._settings.stale_after:.3f} s or later "
                f"expected: the robot's time is {now:.3f} s"
            )
        if self._estimators and stamp <= self._estimators[0].time:
            raise InvalidValue(
                f"{name}: {stamp:.3f} s given, later than the last one, "
                f"{self._estimators[0].time:.3f} s, expected"
            )

    def _check_distance(self, stamp: float, parts: list[Array]) -> None:
        samples = [estimator.sample for estimator in self._estimators]
        distance = self._distance(parts, samples)
        if distance <= self._settings.largest_jump:
            self._far.clear()
            return
        self._far = [
            far for far in self._far if self._distance(parts, far[1]) <= self._settings.jump
        ]
        self._far.append((stamp, parts))
        if len(self._far) > CONFIRMATIONS:
            self._far.clear()
            return
        raise InvalidValue(
            f"target of '{self.task.name}': {distance:.2f} from the last one, at most "
            f"{self._settings.largest_jump:g} [m, rad] expected; held until two more samples agree"
        )

    def _distance(self, parts: list[Array], others: list[Array]) -> float:
        return max(
            float(np.linalg.norm(difference(a, b, rotation)))
            for a, b, rotation in zip(parts, others, self._rotations, strict=True)
        )

    def _parts(self, position: Array) -> list[Array]:
        if self.task.space is ReferenceSpace.POSE:
            return [position[:3], position[3:]]
        return [position]
