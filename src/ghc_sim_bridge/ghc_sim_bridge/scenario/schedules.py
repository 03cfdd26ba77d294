"""What a scenario says of constraint generators: their parameters, contact schedules, events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ghc_controller.schema.reader import Fields
from ghc_mpc_constraints.generators import GENERATORS


@dataclass(frozen=True, slots=True)
class ScriptedSchedule:
    """What a contact may carry: entry i from times[i] on, the last one indefinitely."""

    contact: str
    times: tuple[float, ...]  # (p,) [s] simulated, increasing
    lower: tuple[float, ...]  # (p,) [N] smallest normal force
    upper: tuple[float, ...]  # (p,) [N] largest normal force; 0 = no contact
    known_from: float  # [s] the generator does not look at it before; 0 = from the start


@dataclass(frozen=True, slots=True)
class Event:
    """Event whose torque-rate peak is evaluated, without and with generators."""

    time: float  # [s]
    name: str


def read_generators(fields: Fields) -> Mapping[str, Mapping[str, Any]]:
    """Node -> its parameters; every generator that is named is started.

    Raises ConfigurationError for a node that is no generator, or one without a value.
    """
    for name in fields.given():
        if name not in GENERATORS:
            raise fields.error(name, f"unknown generator; known: {', '.join(GENERATORS)}")
    # A generator without parameters of its own is written as `name: {}`.
    sections = {name: fields.section(name) for name in fields.given()}
    return {
        name: {parameter: section.value(parameter) for parameter in section.given()}
        for name, section in sections.items()
    }


def read_schedule(fields: Fields) -> ScriptedSchedule:
    """One entry of `contact_schedules`; the generator judges what it holds."""
    rows = []
    for entry in fields.sections("bounds"):
        rows.append([entry.number(name) for name in ("time", "lower", "upper")])
        entry.done()
    times, lower, upper = zip(*rows, strict=True)
    schedule = ScriptedSchedule(
        fields.text("contact"), times, lower, upper, fields.number("known_from", 0.0, minimum=0.0)
    )
    fields.done()
    return schedule


def read_events(fields: Fields) -> tuple[Event, ...]:
    """The list `events` of a scenario, in the order of their times."""
    events: list[Event] = []
    for entry in fields.sections("events", optional=True):
        event = Event(entry.number("time", minimum=0.0), entry.text("name"))
        entry.done()
        if events and event.time <= events[-1].time:
            before = events[-1].time
            raise entry.error("time", f"more than {before:g} expected, {event.time:g} given")
        events.append(event)
    return tuple(events)
