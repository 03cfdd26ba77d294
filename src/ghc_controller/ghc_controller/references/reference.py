"""Reference trajectory of a task: points, interpolated at the control rate."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field

import numpy as np

from ghc_controller.core import native
from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.numerics.rotation import (
    matrix_from_quaternion,
    quaternion_conjugate,
    quaternion_product,
    rotation_log,
    vector_motion,
)
from ghc_controller.references.follower import Follower, ReferenceSpace
from ghc_controller.references.polynomials import hermite_coefficients
from ghc_controller.types import UNIT_TOLERANCE, Array, TaskTarget


@dataclass(frozen=True, eq=False)
class ReferenceTrajectory:
    """Points of one task reference, checked on construction; p points of a task with m rows.

    Positions between points are polynomials: quintic with velocity and acceleration (both are met
    at the points, and acceleration is continuous), cubic with velocity only, otherwise linear.
    Orientations are interpolated in the same way in the rotation vector relative to the first
    point of the segment; without derivatives this is slerp. Their velocity and acceleration are
    angular, in world axes. Wrenches are linear between points.
    The position of the first point is held at rest before it, that of the last point after it; to
    stop smoothly, end a trajectory with zero velocity and acceleration.
    """

    task: str  # name of the task, for messages
    space: ReferenceSpace
    size: int  # m
    times: Array  # (p,) [s] after start_time, increasing
    position: Array  # (p, m); (p, 4) quaternion x, y, z, w; (p, 7) pose
    velocity: Array | None = None  # (p, m) [m/s], [rad/s]
    acceleration: Array | None = None  # (p, m) [m/s^2], [rad/s^2]
    wrench: Array | None = None  # (p, m) [N], [Nm] exerted on the environment
    start_time: float = 0.0  # [s] simulation time at which `times` are zero
    _is_vector: bool = field(init=False, repr=False)
    _times: list[float] = field(init=False, repr=False)
    _linear: list[Array] = field(init=False, repr=False)  # p - 1 of (6, vector rows)
    _angular: list[Array] = field(init=False, repr=False)  # p - 1 of (6, 3 or 0), rotation vectors
    _first: TaskTarget = field(init=False, repr=False)
    _last: TaskTarget = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Check, copy, and precompute the polynomials.

        Raises:
            WrongSize, InvalidValue: name the task, the field, what was given and expected.
        """
        self._check_times()
        quaternion = {ReferenceSpace.ORIENTATION: 4, ReferenceSpace.POSE: 7}
        self._check_points("position", quaternion.get(self.space, self.size))
        for name in ("velocity", "acceleration", "wrench"):
            self._check_points(name, self.size)
        if self.acceleration is not None and self.velocity is None:
            raise InvalidValue(
                f"task '{self.task}', acceleration: given without velocity; both or velocity alone"
                " expected"
            )
        self._set("_is_vector", self.space is ReferenceSpace.VECTOR)
        if not self._is_vector:
            self._normalise_quaternions()
        self._set("_times", self.times.tolist())
        self._set("_linear", list(self._linear_segments()))
        self._set("_angular", list(self._angular_segments()))
        self._set("_first", self._held(0))
        self._set("_last", self._held(-1))

    @classmethod
    def for_task(
        cls,
        task: Follower,
        times: Array,
        position: Array,
        velocity: Array | None = None,
        acceleration: Array | None = None,
        wrench: Array | None = None,
        start_time: float = 0.0,
    ) -> ReferenceTrajectory:
        """Trajectory with the sizes and the position space of `task`."""
        return cls(
            task.name,
            task.space,
            task.reference_size,
            times,
            position,
            velocity,
            acceleration,
            wrench,
            start_time,
        )

    @classmethod
    def static(
        cls, task: Follower, target: TaskTarget, start_time: float = 0.0
    ) -> ReferenceTrajectory:
        """One point: the position (and wrench) of `target`, held indefinitely."""
        wrench = None if target.wrench is None else target.wrench[None]
        return cls.for_task(
            task, np.zeros(1), target.position[None], wrench=wrench, start_time=start_time
        )

    @property
    def end_time(self) -> float:
        """[s] of the simulation at the last point."""
        return self.start_time + self._times[-1]

    def rests(self, time: float) -> bool:
        """Whether the reference stands still from `time` [s] on."""
        return len(self._times) == 1 or time - self.start_time > self._times[-1]

    def target(self, time: float) -> TaskTarget:
        """Reference at simulated time [s]; held ends return the same object every time."""
        s = time - self.start_time
        if s < self._times[0] or len(self._times) == 1:
            return self._first
        if s > self._times[-1]:
            return self._last
        segment = min(bisect_right(self._times, s), len(self._times) - 1) - 1
        s -= self._times[segment]
        linear = native.evaluate(self._linear[segment], s)
        if self._is_vector:
            position, velocity, acceleration = linear
        else:
            vector, rate, change = native.evaluate(self._angular[segment], s)
            start = self.position[segment, -4:]
            quaternion, omega, alpha = native.turned_motion(start, vector, rate, change)
            position = np.concatenate([linear[0], quaternion])
            velocity = np.concatenate([linear[1], omega])
            acceleration = np.concatenate([linear[2], alpha])
        wrench = None if self.wrench is None else self._wrench(self.wrench, segment, s)
        return TaskTarget(position, velocity, acceleration, wrench)

    def _wrench(self, points: Array, segment: int, s: float) -> Array:
        share = s / (self._times[segment + 1] - self._times[segment])
        return np.asarray((1.0 - share) * points[segment] + share * points[segment + 1])

    def _linear_segments(self) -> Array:
        rows = {ReferenceSpace.ORIENTATION: 0, ReferenceSpace.POSE: 3}.get(self.space, self.size)
        ends = np.stack([self.position[:-1, :rows], self.position[1:, :rows]], axis=1)
        return hermite_coefficients(
            np.diff(self.times),
            ends,
            _ends(self.velocity, slice(0, rows)),
            _ends(self.acceleration, slice(0, rows)),
        )

    def _angular_segments(self) -> Array:
        count = len(self.times) - 1
        if self.space is ReferenceSpace.VECTOR:
            return np.zeros((count, 6, 0))
        ends = np.zeros((count, 2, 3))
        rates, changes = np.zeros((2, count, 3)), np.zeros((2, count, 3))
        for i in range(count):
            start, end = self.position[i, -4:], self.position[i + 1, -4:]
            ends[i, 1] = rotation_log(quaternion_product(quaternion_conjugate(start), end))
            if self.velocity is None:
                continue
            for side, (vector, quaternion) in enumerate(zip(ends[i], (start, end), strict=True)):
                to_body = matrix_from_quaternion(quaternion).T
                alpha = np.zeros(3)
                if self.acceleration is not None:
                    alpha = to_body @ self.acceleration[i + side, -3:]
                omega = to_body @ self.velocity[i + side, -3:]
                rates[side, i], changes[side, i] = vector_motion(vector, omega, alpha)
        return hermite_coefficients(
            np.diff(self.times),
            ends,
            None if self.velocity is None else (rates[0], rates[1]),
            None if self.acceleration is None else (changes[0], changes[1]),
        )

    def _held(self, point: int) -> TaskTarget:
        wrench = None if self.wrench is None else self.wrench[point].copy()
        return TaskTarget(
            self.position[point].copy(), np.zeros(self.size), np.zeros(self.size), wrench
        )

    def _check_times(self) -> None:
        times = self._finite("times", self.times)
        if times.ndim != 1 or times.size == 0:
            raise WrongSize(f"task '{self.task}', times", times.shape, "(p,) with p >= 1")
        if not (np.diff(times) > 0.0).all():
            late = int(np.argmin(np.diff(times) > 0.0))
            raise InvalidValue(
                f"task '{self.task}', times: {times[late]:g} s, then {times[late + 1]:g} s given,"
                " increasing times expected"
            )
        if not np.isfinite(self.start_time):
            raise InvalidValue(
                f"task '{self.task}', start_time: {self.start_time} given, a finite number"
                " expected"
            )
        self._set("times", times)

    def _check_points(self, name: str, size: int) -> None:
        value = getattr(self, name)
        if value is None:
            return
        value = self._finite(name, value)
        expected = (len(self.times), size)
        if value.shape != expected:
            raise WrongSize(f"task '{self.task}', {name}", value.shape, expected)
        self._set(name, value)

    def _finite(self, name: str, value: Array) -> Array:
        value = np.array(value, dtype=np.float64, order="C")
        if not np.isfinite(value).all():
            place = np.argwhere(~np.isfinite(value))[0].tolist()
            raise InvalidValue(
                f"task '{self.task}', {name}: {value[tuple(place)]} given at {place},"
                " finite numbers expected"
            )
        return value

    def _normalise_quaternions(self) -> None:
        quaternions = self.position[:, -4:]
        lengths = np.linalg.norm(quaternions, axis=1)
        if (np.abs(lengths - 1.0) > UNIT_TOLERANCE).any():
            worst = int(np.argmax(np.abs(lengths - 1.0)))
            raise InvalidValue(
                f"task '{self.task}', position: quaternion of length {lengths[worst]:g} given at"
                f" point {worst}, a unit quaternion x, y, z, w expected"
            )
        quaternions /= lengths[:, None]

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)


def _ends(values: Array | None, columns: slice) -> tuple[Array, Array] | None:
    return None if values is None else (values[:-1, columns], values[1:, columns])
