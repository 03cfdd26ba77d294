"""What a planner allows each contact to carry, and when: piecewise constant normal forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.types import Array
from ghc_mpc_constraints.previews.horizon import STEP_TOLERANCE, Horizon


@dataclass(frozen=True, slots=True, eq=False)
class ContactSchedule:
    """Bounds i hold from times[i] to times[i + 1], the last indefinitely, the first also before.

    Made by `checked`. lower > upper is a schedule that cannot be met: it is accepted, since it
    may come of two planners, and the generator says what it makes of it.
    """

    contact: str
    times: Array  # (p,) [s] strictly increasing
    lower: Array  # (p,) [N] Fmin, 0 or more
    upper: Array  # (p,) [N] Fmax, 0 or more

    @classmethod
    def checked(
        cls,
        contact: str,
        times: Sequence[float],
        lower: Sequence[float],
        upper: Sequence[float],
        known: Sequence[str] = (),
    ) -> ContactSchedule:
        """Schedule of one contact; `known` names the contacts that exist, none = any.

        Raises:
            GhcError: unknown contact, no entries, sizes that differ, times that do not increase,
                numbers that are not finite, negative forces.
        """
        if not contact or (known and contact not in known):
            raise UnknownName("contact", contact, known)
        arrays = {
            name: np.array(values, dtype=np.float64)
            for name, values in (("times", times), ("lower", lower), ("upper", upper))
        }
        where = f"schedule of contact '{contact}'"
        if not len(times):
            raise InvalidValue(f"{where}: no times given, at least one expected")
        for name, array in arrays.items():
            if array.shape != (len(times),):
                raise WrongSize(f"{where}, {name}", len(array), len(times))
            wrong = np.flatnonzero(~np.isfinite(array))
            if len(wrong):
                raise InvalidValue(
                    f"{where}: {name}[{wrong[0]}] = {array[wrong[0]]} given, a finite number "
                    "expected"
                )
        for name in ("lower", "upper"):
            wrong = np.flatnonzero(arrays[name] < 0.0)
            if len(wrong):
                raise InvalidValue(
                    f"{where}: {name}[{wrong[0]}] = {arrays[name][wrong[0]]:g} N given, 0 or more "
                    "expected: a contact pushes"
                )
        wrong = np.flatnonzero(np.diff(arrays["times"]) <= 0.0)
        if len(wrong):
            before, after = arrays["times"][wrong[0] : wrong[0] + 2]
            raise InvalidValue(
                f"{where}: times[{wrong[0]}] = {before:g} s before times[{wrong[0] + 1}] = "
                f"{after:g} s given, increasing times expected"
            )
        return cls(contact, arrays["times"], arrays["lower"], arrays["upper"])

    def followed_by(self, newer: ContactSchedule, now: float) -> ContactSchedule:
        """This one up to the first time of `newer`, that one from there; the past is dropped."""
        kept = self.times < newer.times[0]
        past = np.flatnonzero(self.times <= now)
        if len(past):
            kept[: past[-1]] = False
        return ContactSchedule(
            self.contact,
            *(
                np.concatenate([getattr(self, name)[kept], getattr(newer, name)])
                for name in ("times", "lower", "upper")
            ),
        )

    def at(self, time: float) -> tuple[float, float]:
        """Lower and upper bound [N] in force at one time [s]."""
        index = max(int(np.searchsorted(self.times, time, side="right")) - 1, 0)
        return float(self.lower[index]), float(self.upper[index])


@dataclass(frozen=True, slots=True)
class RawBounds:
    """Raw bounds of one contact at the N + 1 points of a horizon, made consistent."""

    lower: Array  # (N + 1,) [N]
    upper: Array  # (N + 1,) [N], lower <= upper everywhere
    conflict: bool  # the schedule asks for lower > upper somewhere: the upper one was kept


def preview(schedule: ContactSchedule, start: float, horizon: Horizon) -> RawBounds:
    """Bounds that keep every line between two neighbouring points inside the schedule.

    Each point takes the tighter one of the steps on both its sides, so that a bound that is
    interpolated between points is never looser than the raw one, wherever that jumps. Where no
    value is inside both sides the point takes the schedule's own. Where even that is
    contradictory the upper bound wins: it says what the surroundings bear, and it is zero where
    there is no contact.
    """
    times = horizon.times(start)
    slack = STEP_TOLERANCE * horizon.step  # a jump on a point belongs to the step after it
    index = np.searchsorted(schedule.times, times + slack, side="right") - 1
    last = np.searchsorted(schedule.times, times + horizon.step - slack, side="left") - 1
    index, last = np.maximum(index, 0), np.maximum(last, 0)  # the first entry holds from ever
    after = _extremes(schedule, index, last)
    before = [np.concatenate([value[:1], value[:-1]]) for value in after]
    lower, upper = np.maximum(before[0], after[0]), np.minimum(before[1], after[1])
    own_lower, own_upper = schedule.lower[index], schedule.upper[index]
    torn = lower > upper
    lower[torn], upper[torn] = own_lower[torn], own_upper[torn]
    conflict = bool((lower > upper).any())
    return RawBounds(np.minimum(lower, upper), upper, conflict)


def _extremes(
    schedule: ContactSchedule, first: NDArray[np.intp], last: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Largest lower and smallest upper bound of the entries first .. last, per point."""
    lower, upper = schedule.lower[first].copy(), schedule.upper[first].copy()
    for point in np.flatnonzero(last > first):  # rare: a jump inside a step
        inside = slice(first[point], last[point] + 1)
        lower[point] = schedule.lower[inside].max()
        upper[point] = schedule.upper[inside].min()
    return lower, upper
