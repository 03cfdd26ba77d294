"""Keyframe postures, from which the references of several tasks are computed.

Whole-body motions are easier to define by postures than by the references of each task. The joints
move from posture to posture, at rest in each, along minimum-jerk polynomials.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.errors import InvalidField
from ghc_controller.numerics.minimum_jerk import minimum_jerk
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE, Range
from ghc_controller.types import Array

_NONE: Mapping[str, float] = {}


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A posture with zero velocity and acceleration."""

    time: float = declared("simulated", unit="s", domain=NOT_NEGATIVE)
    joints: Mapping[str, float] = declared(
        "joint: position; a joint that is not named keeps its value", unit="rad", fallback=_NONE
    )


@dataclass(frozen=True, slots=True)
class Keyframes:
    """A motion through postures, and the tasks that follow it."""

    tasks: tuple[str, ...] = declared(
        "the tasks that get a reference", of="task names", empty=False
    )
    sample: float = declared(
        "between two points of the references",
        unit="s",
        domain=Range(minimum=1e-3),
        fallback=0.1,
    )
    postures: tuple[Keyframe, ...] = declared(
        "increasing times; before the first: the scene's start", empty=False
    )

    def __post_init__(self) -> None:
        """Raise InvalidField for times that do not increase."""
        for k, (before, after) in enumerate(zip(self.postures, self.postures[1:], strict=False)):
            if after.time <= before.time:
                raise InvalidField(
                    f"postures[{k + 1}].time",
                    f"more than {before.time:g} s (the posture before) expected, "
                    f"{after.time:g} given",
                )

    def sample_times(self) -> tuple[float, ...]:
        """Times [s] at most `sample` apart, including the keyframes."""
        times = [self.postures[0].time]
        for start, end in zip(self.postures[:-1], self.postures[1:], strict=True):
            span = end.time - start.time
            count = max(1, int(np.ceil(span / self.sample - 1e-9)))
            times += [start.time + span * (k + 1) / count for k in range(count)]
        return tuple(times)


@dataclass(frozen=True, slots=True)
class JointMotion:
    """Joint state at an instant."""

    position: Array  # (na,) [rad]
    velocity: Array  # (na,) [rad/s]
    acceleration: Array  # (na,) [rad/s^2]


def joint_motion(
    keyframes: Keyframes, start: Array, names: Sequence[str], t: float
) -> JointMotion:
    """The joints of `names` at time t [s]; `start` (na,) [rad] is their initial posture."""
    place = {name: k for k, name in enumerate(names)}
    postures = [np.array(start, float)]
    for keyframe in keyframes.postures:
        posture = postures[-1].copy()
        for name, value in keyframe.joints.items():
            posture[place[name]] = value
        postures.append(posture)
    times = [keyframe.time for keyframe in keyframes.postures]
    segment = int(np.searchsorted(times, t, side="right"))
    still = np.zeros(len(names))
    if segment in (0, len(times)):
        return JointMotion(postures[max(1, segment)], still, still)
    before, after = postures[segment], postures[segment + 1]
    span = times[segment] - times[segment - 1]
    s = (t - times[segment - 1]) / span
    way = after - before
    share, rate, change = minimum_jerk(s)
    return JointMotion(before + way * share, way * (rate / span), way * (change / span**2))
