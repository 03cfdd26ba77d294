"""What a scenario says of constraint generators: their parameters, contact schedules, events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_mpc_constraints.generators import FORCE_BOUNDS, GENERATORS, OBSTACLE_MOTION
from ghc_mpc_constraints.ros.parameters import ForceBoundParameters, ObstacleParameters

_PARAMETERS: Mapping[str, type] = {  # plan -> parameters of the generators that make it
    FORCE_BOUNDS: ForceBoundParameters,
    OBSTACLE_MOTION: ObstacleParameters,
}


@dataclass(frozen=True, slots=True)
class ScriptedSchedule:
    """What a contact may carry: entry i from times[i] on, the last one indefinitely."""

    contact: str
    times: tuple[float, ...]  # (p,) [s] simulated, increasing
    lower: tuple[float, ...]  # (p,) [N] smallest normal force
    upper: tuple[float, ...]  # (p,) [N] largest normal force; 0 = no contact
    known_from: float  # [s] the generator does not look at it before; 0 = from the start


@dataclass(frozen=True, slots=True)
class BoundsFrom:
    """What a contact may carry from one time on."""

    time: float = declared("simulated", unit="s")
    lower: float = declared("smallest normal force", unit="N")
    upper: float = declared("largest normal force; 0 = no contact", unit="N")


@dataclass(frozen=True, slots=True)
class ScheduleFields:
    """One entry of `contact_schedules`; the generator judges what it holds."""

    contact: str = declared("as in contacts/<name>")
    bounds: tuple[BoundsFrom, ...] = declared("increasing times", empty=False)
    known_from: float = declared(
        "the generator does not look at it before; 0 = from the start",
        0.0,
        unit="s",
        domain=NOT_NEGATIVE,
    )

    def schedule(self) -> ScriptedSchedule:
        """The same by columns."""
        return ScriptedSchedule(
            self.contact,
            tuple(entry.time for entry in self.bounds),
            tuple(entry.lower for entry in self.bounds),
            tuple(entry.upper for entry in self.bounds),
            self.known_from,
        )


@dataclass(frozen=True, slots=True)
class Event:
    """Event whose torque-rate peak is evaluated, without and with generators."""

    time: float = declared("simulated", unit="s", domain=NOT_NEGATIVE)
    name: str = declared("in words")


def generator_parameters(name: str) -> type:
    """Dataclass of the parameters of a generator; raises as `GENERATORS[name]` does."""
    return _PARAMETERS[GENERATORS[name].plan]


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


def read_schedules(scenario: Fields, name: str) -> tuple[ScriptedSchedule, ...]:
    """The list `contact_schedules` of a scenario."""
    entries = scenario.sections(name, optional=True)
    return tuple(read(entry, ScheduleFields).schedule() for entry in entries)
