"""A straight walk on level ground: task references and contact schedules.

As in section 5.4.4 of the thesis: 1 s per step, of which 0.3 s in double support. The zero-moment
point moves from one sole to the other in double support, and the center of mass follows it by
preview control (Kajita et al. 2003). Each step begins with its double support.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import InvalidField
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE, Range
from ghc_controller.types import Array
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_sim_bridge.scenario.references import Reference, ReferencePoint, Vector
from ghc_sim_bridge.scenario.schedules import Event
from ghc_sim_bridge.scenario.walk.zmp_preview import ZmpPreview

SHORTEST_SWING = 0.05  # [s]
PREVIEW_STEP = 0.01  # [s]
PATH_SAMPLES = 2  # preview steps between two points of the reference, a quintic
SETTLED = 2.0  # [s] from the last step until the center of mass is at rest


@dataclass(frozen=True, slots=True)
class Foot:
    """One foot: its swing task, its contact, and its initial pose."""

    task: str = declared("that swings it")
    contact: str = declared("that it stands on")
    pose: Vector = declared("where it starts, world: [m], then a quaternion x, y, z, w", size=7)


@dataclass(frozen=True, slots=True)
class Walk:
    """Section `walk` of a scenario: a walk along the world's x axis on the ground z = 0."""

    task: str = declared("of the center of mass")
    center_of_mass: Vector = declared(
        "at the start and, carried along, at the end", unit="m", size=3
    )
    feet: tuple[Foot, Foot] = declared("the first one swings first")
    start: float = declared("beginning of the first step", unit="s", domain=Range(minimum=0.1))
    steps: int = declared("the last one closes the feet", unit="-", domain=Range(minimum=1.0))
    length: float = declared("by which a foot lands ahead of the other one", unit="m")
    height: float = declared("of the swing foot", unit="m", domain=NOT_NEGATIVE)
    step_time: float = declared("of a step", unit="s", domain=Range(minimum=SHORTEST_SWING))
    double_support: float = declared("of each step", unit="s", domain=Range(minimum=0.01))
    settle: float = declared(
        "of the swing, at its end: the foot rests on the ground, not yet a contact",
        unit="s",
        domain=NOT_NEGATIVE,
        fallback=0.05,
    )
    force_upper: float = declared("of a foot that stands", unit="N", domain=NOT_NEGATIVE)
    force_unloaded: float = declared(
        "of the leaving foot before its break, of the other after its touch",
        unit="N",
        domain=NOT_NEGATIVE,
    )

    def __post_init__(self) -> None:
        """Raise InvalidField for a center of mass below ground or steps without a swing phase."""
        height = self.center_of_mass[2]
        if height <= 0.0:
            raise InvalidField("center_of_mass", f"a height above 0 expected, {height:g} given")
        swing = self.step_time - self.double_support - self.settle
        if swing < SHORTEST_SWING:
            raise InvalidField(
                "step_time",
                f"{swing:g} s are left for the swing, at least {SHORTEST_SWING} expected",
            )


class Step(NamedTuple):
    """One step: times, and positions along x."""

    swing: int  # index of the swing foot
    begins: float  # [s] double support
    breaks: float  # [s]
    touches: float  # [s]
    origin: float  # [m] x of the swing foot relative to its start
    goal: float  # [m]
    stance: float  # [m] x of the other foot


def walk_steps(walk: Walk) -> Iterator[Step]:
    """The steps in the order of their times."""
    place = [0.0, 0.0]
    for k in range(walk.steps):
        swing = k % 2
        begins = walk.start + k * walk.step_time
        stance = place[1 - swing]
        goal = stance if k == walk.steps - 1 else stance + walk.length
        yield Step(
            swing,
            begins,
            begins + walk.double_support,
            begins + walk.step_time,
            place[swing],
            goal,
            stance,
        )
        place[swing] = goal


def walk_references(walk: Walk) -> tuple[Reference, ...]:
    """References of the center of mass and of both feet."""
    feet = (Reference(foot.task, _swings(walk, k)) for k, foot in enumerate(walk.feet))
    return (Reference(walk.task, _center_of_mass(walk)), *feet)


def walk_schedules(walk: Walk) -> tuple[ContactSchedule, ...]:
    """Largest normal force of both contacts: zero during swing, small just before and after."""
    return tuple(_schedule(walk, k) for k in range(2))


def walk_events(walk: Walk) -> tuple[Event, ...]:
    """Every lift-off and touch-down, named by step and contact."""
    return tuple(
        Event(round(time, 9), f"{k}: {walk.feet[step.swing].contact} {what}")
        for k, step in enumerate(walk_steps(walk), start=1)
        for time, what in ((step.breaks, "breaks"), (step.touches, "touches"))
    )


def wanted_zmp(walk: Walk) -> Array:
    """Reference of the zero-moment point (T, 2) [m], every PREVIEW_STEP from time 0.

    Its offset from each stance foot is the initial offset of the center of mass from both.
    """
    middle = np.mean([foot.pose[:2] for foot in walk.feet], axis=0)
    offset = np.array(walk.center_of_mass[:2]) - middle
    times, points = [0.0], [middle + offset]
    here = points[0]
    end = walk.start
    steps = tuple(walk_steps(walk))
    for step in steps:
        there = np.array(walk.feet[1 - step.swing].pose[:2]) + [step.stance, 0.0] + offset
        times += [step.begins, step.breaks]
        points += [here, there]
        here, end = there, step.touches
    last = middle + offset + [steps[-1].goal, 0.0]
    times += [end, end + walk.double_support, end + walk.double_support + SETTLED]
    points += [here, last, last]
    samples = PREVIEW_STEP * np.arange(round(times[-1] / PREVIEW_STEP) + 1)
    return np.stack([np.interp(samples, times, axis) for axis in np.transpose(points)], axis=1)


def _center_of_mass(walk: Walk) -> tuple[ReferencePoint, ...]:
    height = walk.center_of_mass[2]
    preview = ZmpPreview(height, PREVIEW_STEP)
    start = walk.center_of_mass
    zmp = wanted_zmp(walk)
    x, y = (preview.path(zmp[:, k], (start[k], 0.0, 0.0)) for k in range(2))
    return tuple(
        ReferencePoint(
            round(PREVIEW_STEP * k, 9),
            (float(x.position[k]), float(y.position[k]), height),
            (float(x.velocity[k]), float(y.velocity[k]), 0.0),
            (float(x.acceleration[k]), float(y.acceleration[k]), 0.0),
        )
        for k in range(0, len(zmp), PATH_SAMPLES)
    )


def _swings(walk: Walk, foot: int) -> tuple[ReferencePoint, ...]:
    """Minimum jerk: along x over the whole swing, up in its first half, down in its second."""
    x, y, z, *rotation = walk.feet[foot].pose
    still = (0.0,) * 6

    def point(time: float, along: float, up: float, speed: float = 0.0) -> ReferencePoint:
        pose = (x + along, y, z + up, *rotation)
        return ReferencePoint(round(time, 9), pose, (speed, *still[1:]), still)

    points = [point(0.0, 0.0, 0.0)]
    for step in walk_steps(walk):
        if step.swing != foot:
            continue
        duration = step.touches - walk.settle - step.breaks
        way = step.goal - step.origin
        middle = step.breaks + 0.5 * duration
        points += [
            point(step.breaks, step.origin, 0.0),
            point(middle, step.origin + 0.5 * way, walk.height, 1.875 * way / duration),
            point(step.breaks + duration, step.goal, 0.0),
        ]
    return tuple(points)


def _schedule(walk: Walk, foot: int) -> ContactSchedule:
    entries = [(0.0, walk.force_upper)]
    half = 0.5 * walk.double_support
    for step in walk_steps(walk):
        if step.swing == foot:
            entries += [
                (step.breaks - half, walk.force_unloaded),
                (step.breaks, 0.0),
                (step.touches, walk.force_unloaded),
                (step.touches + half, walk.force_upper),
            ]
    times, upper = zip(*((round(time, 9), force) for time, force in entries), strict=True)
    return ContactSchedule.checked(walk.feet[foot].contact, times, [0.0] * len(times), upper)
