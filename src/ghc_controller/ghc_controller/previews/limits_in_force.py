"""Current limits of joints, or margins: of the robot's file, or tighter ones of a preview."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ghc_controller.core import native
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.previews.preview import TORQUE_LIMITS, Preview, StaleRule
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

    A joint that is not in the preview keeps the limits of the robot's file. After the end of a
    preview its last point holds, unless its stale rule differs.

    Attributes:
        preview: the one that is followed; None without.
    """

    def __init__(
        self, kind: str, joints: Sequence[str], lower: Array, upper: Array, thing: str = "joint"
    ) -> None:
        """Limits (a,) of the robot's file; `thing` says what has them."""
        self.kind = kind
        self._thing = thing
        self._joints = tuple(joints)
        none = np.zeros((2, len(joints)))
        self._file = MovingLimits(lower.copy(), upper.copy(), none, none)
        self.reset()

    def reset(self) -> None:
        """Forget the preview."""
        self.preview: Preview | None = None
        self._places = _NOWHERE

    @property
    def planned(self) -> tuple[str, ...]:
        """Joints of the preview that is followed."""
        return () if self.preview is None else self.preview.rows

    def place_of(self, joint: str) -> int:
        """Index of a joint in the arrays (a,)."""
        return self._joints.index(joint)

    def is_stale(self, time: float) -> bool:
        """Whether the preview has ended."""
        preview = self.preview
        return preview is not None and bool(preview.rows) and preview.has_ended(time)

    def follow(self, preview: Preview, _now: float | None = None) -> tuple[UnknownName, ...]:
        """Use a preview for those of its joints that the robot has.

        Returns:
            An error for each joint that was ignored; empty when none was.

        Raises:
            InvalidValue: limits that exclude each other or the whole range of the robot's file,
                that are not finite, or a torque limit that excludes zero; the previous preview
                stays.
        """
        if preview.motions:
            raise InvalidValue(f"{self.kind}: motions given, bounds of {self._thing}s expected")
        unknown = tuple(name for name in preview.rows if name not in self._joints)
        if unknown:
            preview = preview.without(unknown)
        places = np.array([self._joints.index(name) for name in preview.rows], dtype=np.intp)
        self.preview = self._within_file(preview, places)
        self._places = places
        return tuple(UnknownName(self._thing, name, self._joints) for name in unknown)

    def at(self, time: float) -> MovingLimits:
        """Limits at a time [s]."""
        preview, file = self.preview, self._file
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
                motion = native.motion_of(points, place, preview.step)
                rates[side, self._places], accelerations[side, self._places] = motion
        return MovingLimits(lower, upper, rates, accelerations)

    def _within_file(self, preview: Preview, places: np.ndarray) -> Preview:
        least, most = self._file.lower[places, None], self._file.upper[places, None]
        lower, upper = np.maximum(preview.lower, least), np.minimum(preview.upper, most)
        wrong = ~(np.isfinite(lower) & np.isfinite(upper) & (lower <= upper))
        what = "finite lower <= upper, inside the limits of the robot's file"
        if self.kind == TORQUE_LIMITS:
            wrong |= (lower > 0.0) | (upper < 0.0)
            what += " and on both sides of zero"
        if wrong.any():
            row, point = np.argwhere(wrong)[0]
            raise InvalidValue(
                f"{self._thing} '{preview.rows[row]}': lower {preview.lower[row, point]:g} and "
                f"upper {preview.upper[row, point]:g} given, {what}, expected"
            )
        return replace(preview, lower=lower, upper=upper)
