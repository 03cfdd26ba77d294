"""Which limits of joints hold now: those of the robot's file, or tighter ones of a preview."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.previews.preview import JOINT_LIMITS, Preview, StaleRule
from ghc_controller.types import Array

_NOWHERE = np.zeros(0, dtype=np.intp)


@dataclass(frozen=True, slots=True)
class MovingLimits:
    """Limits of a joints at one instant, and how they move."""

    lower: Array  # (a,) [rad] or [Nm]
    upper: Array  # (a,)
    rates: Array  # (2, a) of lower and upper, per s
    accelerations: Array  # (2, a) per s^2


class LimitsInForce:
    """Follows the newest preview of one kind; never looser than the robot's file.

    A joint that the preview leaves out keeps what the robot's file says. After the end of a
    preview its last point holds, unless its stale rule says otherwise.
    """

    def __init__(self, kind: str, joints: Sequence[str], lower: Array, upper: Array) -> None:
        """Limits (a,) of the robot's file."""
        self.kind = kind
        self._joints = tuple(joints)
        none = np.zeros((2, len(joints)))
        self._file = MovingLimits(lower.copy(), upper.copy(), none, none)
        self.reset()

    def reset(self) -> None:
        """Forget the preview."""
        self._preview: Preview | None = None
        self._places = _NOWHERE

    @property
    def planned(self) -> tuple[str, ...]:
        """Joints of the preview that is followed."""
        return () if self._preview is None else self._preview.rows

    def place_of(self, joint: str) -> int:
        """Index of a joint in the arrays (a,)."""
        return self._joints.index(joint)

    def is_stale(self, time: float) -> bool:
        """Whether the preview has ended."""
        return bool(self.planned) and self._preview is not None and self._preview.has_ended(time)

    def follow(self, preview: Preview, _now: float | None = None) -> tuple[UnknownName, ...]:
        """Take a preview over, as far as it speaks of joints that the robot has.

        Returns:
            What is wrong with each joint that was left out; empty when none was.

        Raises:
            InvalidValue: limits that exclude each other or all that the robot's file allows, or a
                torque limit that excludes zero; the preview before stays.
        """
        unknown = tuple(name for name in preview.rows if name not in self._joints)
        if unknown:
            preview = preview.without(unknown)
        places = np.array([self._joints.index(name) for name in preview.rows], dtype=np.intp)
        self._preview = self._within_file(preview, places)
        self._places = places
        return tuple(UnknownName("joint", name, self._joints) for name in unknown)

    def at(self, time: float) -> MovingLimits:
        """Limits at a time [s]."""
        preview, file = self._preview, self._file
        if preview is None or not preview.rows:
            return file
        ended = preview.has_ended(time)
        if ended and preview.stale is StaleRule.RELEASE:
            return file
        lower, upper = file.lower.copy(), file.upper.copy()
        rates, accelerations = np.zeros_like(file.rates), np.zeros_like(file.rates)
        planned = preview.at(time)
        moves = preview.interpolate and not ended
        for side, (limit, points) in enumerate(((lower, preview.lower), (upper, preview.upper))):
            limit[self._places] = planned[side]
            if moves and points.shape[1] > 4:
                place = (time - preview.start) / preview.step
                motion = motion_of(points, place, preview.step)
                rates[side, self._places], accelerations[side, self._places] = motion
        return MovingLimits(lower, upper, rates, accelerations)

    def _within_file(self, preview: Preview, places: np.ndarray) -> Preview:
        least, most = self._file.lower[places, None], self._file.upper[places, None]
        lower, upper = np.maximum(preview.lower, least), np.minimum(preview.upper, most)
        wrong = lower > upper
        what = "lower <= upper, inside the limits of the robot's file"
        if self.kind != JOINT_LIMITS:
            wrong |= (lower > 0.0) | (upper < 0.0)
            what += " and on both sides of zero"
        if wrong.any():
            row, point = np.argwhere(wrong)[0]
            raise InvalidValue(
                f"joint '{preview.rows[row]}': lower {preview.lower[row, point]:g} and upper "
                f"{preview.upper[row, point]:g} given, {what}, expected"
            )
        return replace(preview, lower=lower, upper=upper)


@njit(cache=True)
def motion_of(points: Array, place: float, step: float) -> tuple[Array, Array]:
    """Rate and acceleration (r,) at a place [points from the first] of points (r, N + 1), N >= 4.

    Exact for points of a chain of three integrators whose jerk is the same over some steps;
    neither jumps inside a preview.
    """
    last = points.shape[1] - 1
    place = min(max(place, 0.0), float(last))
    left = min(int(place), last - 1)
    share = place - left
    rate, acceleration = np.empty(points.shape[0]), np.empty(points.shape[0])
    for k in range(points.shape[0]):
        values = points[k]
        now, then = _curvature(values, left, step), _curvature(values, left + 1, step)
        acceleration[k] = (1.0 - share) * now + share * then
        ahead = share * step * (now + 0.5 * share * (then - now))
        back = (1.0 - share) * step * (then - 0.5 * (1.0 - share) * (then - now))
        # From both points, so that nothing jumps where the next step begins.
        rate[k] = (1.0 - share) * (_rate(values, left, step) + ahead) + share * (
            _rate(values, left + 1, step) - back
        )
    return rate, acceleration


@njit(cache=True)
def _rate(values: Array, j: int, step: float) -> float:
    """Of third order, from five points, or from four at the ends."""
    last = values.shape[0] - 1
    if j == 0:
        return _forward(values[0], values[1], values[2], values[3], step)
    if j == 1:
        return _inside(values[0], values[1], values[2], values[3], step)
    if j == last:
        return -_forward(values[j], values[j - 1], values[j - 2], values[j - 3], step)
    if j == last - 1:
        return -_inside(values[j + 1], values[j], values[j - 1], values[j - 2], step)
    near, far = values[j + 1] - values[j - 1], values[j + 2] - values[j - 2]
    return (8.0 * near - far) / (12.0 * step)


@njit(cache=True)
def _forward(p0: float, p1: float, p2: float, p3: float, step: float) -> float:
    """At p0."""
    return (-11.0 * p0 + 18.0 * p1 - 9.0 * p2 + 2.0 * p3) / (6.0 * step)


@njit(cache=True)
def _inside(p0: float, p1: float, p2: float, p3: float, step: float) -> float:
    """At p1."""
    return (-2.0 * p0 - 3.0 * p1 + 6.0 * p2 - p3) / (6.0 * step)


@njit(cache=True)
def _inner(values: Array, j: int, step: float) -> float:
    return (values[j + 1] - 2.0 * values[j] + values[j - 1]) / (step * step)


@njit(cache=True)
def _curvature(values: Array, j: int, step: float) -> float:
    last = values.shape[0] - 1
    if j == 0:
        return 2.0 * _inner(values, 1, step) - _inner(values, 2, step)
    if j == last:
        return 2.0 * _inner(values, last - 1, step) - _inner(values, last - 2, step)
    return _inner(values, j, step)
