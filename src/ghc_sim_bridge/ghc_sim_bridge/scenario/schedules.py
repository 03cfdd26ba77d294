"""Sections of a scenario for constraint generators: parameters, schedules, events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from ghc_controller.errors import GhcError
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_mpc_constraints.generator import GENERATORS, Schedules
from ghc_mpc_constraints.ros.parameters import generator_parameters
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule

S = TypeVar("S", bound=LimitSchedule)
S_co = TypeVar("S_co", bound=LimitSchedule, covariant=True)

FARTHEST_MARGIN = 1e3  # [m] upper bound of a margin, which has none
_KNOWN_FROM = declared(
    "the generator does not use it before this time; 0 = from the start",
    0.0,
    unit="s",
    domain=NOT_NEGATIVE,
)


class Entry(Protocol[S_co]):
    """Fields of one schedule in a scenario file."""

    def schedule(self) -> S_co:
        """The schedule; GhcError if it is invalid."""


@dataclass(frozen=True, slots=True)
class BoundsFrom:
    """Force bounds of a contact from one time on."""

    time: float = declared("simulated", unit="s")
    lower: float = declared("smallest normal force", unit="N")
    upper: float = declared("largest normal force; 0 = no contact", unit="N")


@dataclass(frozen=True, slots=True)
class ScheduleFields:
    """One entry of `contact_schedules`."""

    contact: str = declared("as in contacts/<name>")
    bounds: tuple[BoundsFrom, ...] = declared("increasing times", empty=False)
    known_from: float = _KNOWN_FROM

    def schedule(self) -> ContactSchedule:
        """The schedule; GhcError as ContactSchedule.checked."""
        times, lower, upper = _columns(self.bounds)
        return ContactSchedule.checked(
            self.contact, times, lower, upper, (), self.known_from or None
        )


@dataclass(frozen=True, slots=True)
class LimitsFrom:
    """Limits of a joint from one time on."""

    time: float = declared("simulated", unit="s")
    lower: float = declared("smallest position or torque", unit="rad or Nm")
    upper: float = declared("largest position or torque", unit="rad or Nm")


@dataclass(frozen=True, slots=True)
class LimitFields:
    """One entry of `joint_limit_schedules` or `torque_limit_schedules`."""

    joint: str = declared("name of a joint")
    limits: tuple[LimitsFrom, ...] = declared("increasing times", empty=False)
    known_from: float = _KNOWN_FROM

    def schedule(self) -> LimitSchedule:
        """The schedule; GhcError as LimitSchedule.checked."""
        times, lower, upper = _columns(self.limits)
        return LimitSchedule.checked(self.joint, times, lower, upper, (), self.known_from or None)


@dataclass(frozen=True, slots=True)
class MarginFrom:
    """A margin from one time on."""

    time: float = declared("simulated", unit="s")
    margin: float = declared("distance to be kept", unit="m")


@dataclass(frozen=True, slots=True)
class MarginFields:
    """One entry of `body_margin_schedules`."""

    name: str = declared("of the margin, in the constraint `body_distance` of robot.yaml")
    margins: tuple[MarginFrom, ...] = declared("increasing times", empty=False)
    known_from: float = _KNOWN_FROM

    def schedule(self) -> LimitSchedule:
        """The schedule itself; GhcError as LimitSchedule.checked."""
        times = [entry.time for entry in self.margins]
        lower = [entry.margin for entry in self.margins]
        upper = [FARTHEST_MARGIN] * len(times)
        return LimitSchedule.checked(self.name, times, lower, upper, (), self.known_from or None)


def _columns(
    entries: Sequence[BoundsFrom] | Sequence[LimitsFrom],
) -> tuple[list[float], list[float], list[float]]:
    """Times, lower and upper."""
    times = [entry.time for entry in entries]
    return times, [entry.lower for entry in entries], [entry.upper for entry in entries]


# Section of a scenario -> topic of its schedules, which determines the reading generator.
SECTIONS: Mapping[str, str] = {
    "contact_schedules": "constraints/contact_schedule",
    "joint_limit_schedules": "constraints/joint_limit_schedule",
    "torque_limit_schedules": "constraints/torque_limit_schedule",
    "body_margin_schedules": "constraints/body_margin_schedule",
}


@dataclass(frozen=True, slots=True)
class Event:
    """Event whose torque-rate peak is evaluated, without and with generators."""

    time: float = declared("simulated", unit="s", domain=NOT_NEGATIVE)
    name: str = declared("in words")


def reads_schedules(generator: str) -> bool:
    """Whether the input of a generator is a schedule; raises as `GENERATORS[name]`."""
    return isinstance(GENERATORS[generator].input, Schedules)


def read_generators(scenario: Fields, name: str) -> Mapping[str, Mapping[str, Any]]:
    """Node -> its parameters; every generator that is named is started.

    Raises ConfigurationError for an unknown generator, or one without a value.
    """
    fields = scenario.section(name, optional=True)
    for name in fields.given():
        if name not in GENERATORS:
            raise fields.error(name, f"unknown generator; known: {', '.join(GENERATORS)}")
    # A generator without parameters is written as `name: {}`.
    sections = {name: fields.section(name) for name in fields.given()}
    for name, section in sections.items():
        read(section, generator_parameters(name))
    return {name: section.values for name, section in sections.items()}


def read_schedules(scenario: Fields, name: str, entry: type[Entry[S]]) -> tuple[S, ...]:
    """The list of schedules `name` of a scenario, each as an `entry`.

    Raises ConfigurationError for an invalid schedule.
    """
    return tuple(_schedule(one, entry) for one in scenario.sections(name, optional=True))


def _schedule(fields: Fields, entry: type[Entry[S]]) -> S:
    found = read(fields, entry)
    try:
        return found.schedule()
    except GhcError as error:
        raise fields.complaint(str(error)) from error
