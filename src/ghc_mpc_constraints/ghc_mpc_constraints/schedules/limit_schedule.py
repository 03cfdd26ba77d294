"""Piecewise constant bounds of one joint or contact over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeVar

import numpy as np

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.types import Array

S = TypeVar("S", bound="LimitSchedule")


@dataclass(frozen=True, slots=True, eq=False)
class LimitSchedule:
    """Bounds i hold from times[i] to times[i + 1], the last indefinitely, the first also before.

    Constructed by `checked`. A schedule with lower > upper is infeasible but accepted, since it
    may result from two planners; the generator reports how it resolves it.
    """

    THING: ClassVar[str] = "joint"
    SMALLEST: ClassVar[float] = -math.inf
    WHY: ClassVar[str] = ""

    name: str  # of the joint or contact
    times: Array  # (p,) [s] strictly increasing
    lower: Array  # (p,) [rad], [Nm] or [N]
    upper: Array  # (p,)
    known_from: float | None = None  # [s] time from which the generator uses it; None: at once

    def __eq__(self, other: object) -> bool:
        """Whether row and content are equal."""
        if not isinstance(other, LimitSchedule):
            return NotImplemented
        return type(other) is type(self) and self._content == other._content

    def __hash__(self) -> int:
        """Hash of row and content."""
        return hash(self._content)

    @property
    def _content(self) -> tuple[object, ...]:
        arrays = (self.times, self.lower, self.upper)
        return (self.name, self.known_from, *(array.tobytes() for array in arrays))

    @classmethod
    def checked(
        cls: type[S],
        name: str,
        times: Sequence[float],
        lower: Sequence[float],
        upper: Sequence[float],
        known: Sequence[str] = (),
        known_from: float | None = None,
    ) -> S:
        """Schedule of one row; `known` names the existing rows, empty = any.

        Raises:
            GhcError: unknown name, no entries, sizes that differ, times that do not increase,
                numbers that are not finite or below the smallest.
        """
        if not name or (known and name not in known):
            raise UnknownName(cls.THING, name, known)
        arrays = {
            key: np.array(values, dtype=np.float64)
            for key, values in (("times", times), ("lower", lower), ("upper", upper))
        }
        where = f"schedule of {cls.THING} '{name}'"
        if not len(times):
            raise InvalidValue(f"{where}: no times given, at least one expected")
        for key, array in arrays.items():
            if array.shape != (len(times),):
                raise WrongSize(f"{where}, {key}", len(array), len(times))
            wrong = np.flatnonzero(~np.isfinite(array))
            if len(wrong):
                raise InvalidValue(
                    f"{where}: {key}[{wrong[0]}] = {array[wrong[0]]} given, a finite number "
                    "expected"
                )
        for key in ("lower", "upper"):
            wrong = np.flatnonzero(arrays[key] < cls.SMALLEST)
            if len(wrong):
                raise InvalidValue(
                    f"{where}: {key}[{wrong[0]}] = {arrays[key][wrong[0]]:g}{cls.WHY}"
                )
        wrong = np.flatnonzero(np.diff(arrays["times"]) <= 0.0)
        if len(wrong):
            before, after = arrays["times"][wrong[0] : wrong[0] + 2]
            raise InvalidValue(
                f"{where}: times[{wrong[0]}] = {before:g} s before times[{wrong[0] + 1}] = "
                f"{after:g} s given, increasing times expected"
            )
        return cls(name, arrays["times"], arrays["lower"], arrays["upper"], known_from)

    @classmethod
    def read(cls: type[S], message: Any, start: float, known: Sequence[str] = ()) -> tuple[S, ...]:
        """Schedules of a ghc_msgs/LimitSchedule whose times count from `start` [s].

        Raises:
            GhcError: as `checked`; inconsistent sizes, duplicate or missing names.
        """
        names, points = list(message.names), len(message.times)
        if not names or len(set(names)) != len(names):
            raise InvalidValue(f"schedule: names {names} given, one or more, each once, expected")
        times = start + np.array(message.times, dtype=np.float64)
        rows = {}
        for key in ("lower", "upper"):
            values = np.array(getattr(message, key), dtype=np.float64)
            if values.shape != (len(names) * points,):
                raise WrongSize(f"schedule, {key}", len(values), f"{len(names)} * {points}")
            rows[key] = values.reshape(len(names), points).tolist()
        return tuple(
            cls.checked(name, times.tolist(), rows["lower"][i], rows["upper"][i], known)
            for i, name in enumerate(names)
        )

    def known_at(self: S, time: float | None) -> S:
        """The same, known from a time [s] on; None = at once."""
        return self if time == self.known_from else replace(self, known_from=time)

    def followed_by(self: S, newer: S, now: float) -> S:
        """This schedule up to the first time of `newer`, then `newer`; past entries are cut."""
        kept = self.times < newer.times[0]
        past = np.flatnonzero(self.times <= now)
        if len(past):
            kept[: past[-1]] = False
        times, lower, upper = (
            np.concatenate([getattr(self, key)[kept], getattr(newer, key)])
            for key in ("times", "lower", "upper")
        )
        return replace(newer, times=times, lower=lower, upper=upper)

    def at(self, time: float) -> tuple[float, float]:
        """Lower and upper bound in force at one time [s]."""
        index = max(int(np.searchsorted(self.times, time, side="right")) - 1, 0)
        return float(self.lower[index]), float(self.upper[index])
