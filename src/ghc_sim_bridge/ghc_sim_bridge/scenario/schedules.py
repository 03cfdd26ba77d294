"""What a scenario says of constraint generators: their parameters, schedules, events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ghc_controller.errors import GhcError
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_mpc_constraints.generator import GENERATORS, Schedules
from ghc_mpc_constraints.ros.parameters import generator_parameters
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule

_KNOWN_FROM = declared(
    "the generator does not look at it before; 0 = from the start",
    0.0,
    unit="s",
    domain=NOT_NEGATIVE,
)


@dataclass(frozen=True, slots=True)
class BoundsFrom:
    """What a contact may carry from one time on."""

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
        """The schedule itself; GhcError as ContactSchedule.checked."""
        times, lower, upper = _columns(self.bounds)
        return ContactSchedule.checked(
            self.contact, times, lower, upper, (), self.known_from or None
        )


@dataclass(frozen=True, slots=True)
class LimitsFrom:
    """What a joint may do from one time on."""

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
        """The schedule itself; GhcError as LimitSchedule.checked."""
        times, lower, upper = _columns(self.limits)
        return LimitSchedule.checked(self.joint, times, lower, upper, (), self.known_from or None)


def _columns(
    entries: Sequence[BoundsFrom] | Sequence[LimitsFrom],
) -> tuple[list[float], list[float], list[float]]:
    """Times, lower and upper."""
    times = [entry.time for entry in entries]
    return times, [entry.lower for entry in entries], [entry.upper for entry in entries]


# Section of a scenario -> topic on which its schedules go, and so who reads them.
SECTIONS: Mapping[str, str] = {
    "contact_schedules": "constraints/contact_schedule",
    "joint_limit_schedules": "constraints/joint_limit_schedule",
    "torque_limit_schedules": "constraints/torque_limit_schedule",
}


@dataclass(frozen=True, slots=True)
class Event:
    """Event whose torque-rate peak is evaluated, without and with generators."""

    time: float = declared("simulated", unit="s", domain=NOT_NEGATIVE)
    name: str = declared("in words")


def reads_schedules(generator: str) -> bool:
    """Whether a generator takes schedules; raises as `GENERATORS[name]` does."""
    return isinstance(GENERATORS[generator].input, Schedules)


def read_generators(scenario: Fields, name: str) -> Mapping[str, Mapping[str, Any]]:
    """Node -> its parameters; every generator that is named is started.

    Raises ConfigurationError for a node that is no generator, or one without a value.
    """
    fields = scenario.section(name, optional=True)
    for name in fields.given():
        if name not in GENERATORS:
            raise fields.error(name, f"unknown generator; known: {', '.join(GENERATORS)}")
    # A generator without parameters of its own is written as `name: {}`.
    sections = {name: fields.section(name) for name in fields.given()}
    for name, section in sections.items():
        read(section, generator_parameters(name))
    return {name: section.values for name, section in sections.items()}


def read_schedules(scenario: Fields, name: str) -> tuple[ContactSchedule, ...]:
    """The list `contact_schedules` of a scenario.

    Raises ConfigurationError for what is no schedule.
    """
    return tuple(
        _checked(entry, read(entry, ScheduleFields))
        for entry in scenario.sections(name, optional=True)
    )


def read_limits(scenario: Fields, name: str) -> tuple[LimitSchedule, ...]:
    """The list `joint_limit_schedules` or `torque_limit_schedules` of a scenario; raises alike."""
    return tuple(
        _checked(entry, read(entry, LimitFields))
        for entry in scenario.sections(name, optional=True)
    )


def _checked(entry: Fields, fields: ScheduleFields | LimitFields) -> Any:
    try:
        return fields.schedule()
    except GhcError as error:
        raise entry.complaint(str(error)) from error
