"""Declared fields of a scenario file: what one experiment runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ghc_controller.errors import InvalidField
from ghc_controller.formulations import DEFAULT_FORMULATION, FORMULATIONS
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE, Range
from ghc_controller.types import CONTROL_DT
from ghc_mpc_constraints.generator import GENERATORS
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule
from ghc_sim_bridge.scenario.keyframes import Keyframes
from ghc_sim_bridge.scenario.node_sections import NODES, read_formulations, read_parameters
from ghc_sim_bridge.scenario.phase import Phase
from ghc_sim_bridge.scenario.references import Reference, ReferenceFields, read_references
from ghc_sim_bridge.scenario.schedules import (
    SECTIONS,
    Event,
    LimitFields,
    ScheduleFields,
    read_generators,
    read_limits,
    read_schedules,
)
from ghc_sim_bridge.scenario.walk.walk import Walk


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """One experiment, ready to be planned; the last three fields are not of the file."""

    name: str = declared("folder below results/; empty = name of the file", "")
    title: str = declared("words for tables")
    robot: str = declared("name of a robot, or path from where the run is started")
    scene: str = declared("name of a scene, or path from where the run is started")
    formulation: str = declared("name of a formulation", DEFAULT_FORMULATION)
    control_dt: float = declared(
        "control period", CONTROL_DT, unit="s", domain=Range(minimum=1e-6)
    )
    transition: float = declared("duration of each ramp", 2.0, unit="s", domain=NOT_NEGATIVE)
    torque_rate: float = declared(
        "budget of each ramp, which may then take longer; 0 = none",
        0.0,
        unit="Nm/s",
        domain=NOT_NEGATIVE,
    )
    hold: float = declared(
        "after each ramp; also a field of a phase", 8.0, unit="s", domain=NOT_NEGATIVE
    )
    torque_rate_limit: float = declared(
        "of controller and bridge; 0 = off", unit="Nm/s", domain=NOT_NEGATIVE
    )
    references: tuple[Reference, ...] = declared(
        "task: its reference",
        (),
        read=read_references,
        schema=lambda schema: schema.mapping(schema.record(ReferenceFields)),
    )
    keyframes: Keyframes | None = declared("more references, as postures of the body", None)
    walk: Walk | None = declared("a walk along x: adds references, schedules and events", None)
    phases: tuple[Phase, ...] = declared("one after the other", empty=False)
    parameters: Mapping[str, Mapping[str, Any]] = declared(
        "node: further parameters",
        dict,
        read=read_parameters,
        schema=lambda schema: schema.node_parameters((*NODES, *GENERATORS.built_in)),
    )
    formulation_parameters: Mapping[str, Mapping[str, Any]] = declared(
        "formulation: further parameters of the controller with it",
        dict,
        read=read_formulations,
        schema=lambda schema: schema.by_name(
            FORMULATIONS.built_in, schema.parameters_of("controller")
        ),
    )
    robot_changes: Mapping[str, Any] = declared(
        "merged into robot.yaml, tasks and contacts found by name", dict
    )
    generators: Mapping[str, Mapping[str, Any]] = declared(
        "node: its parameters; every generator that is named is started",
        dict,
        read=read_generators,
        schema=lambda schema: schema.node_parameters(GENERATORS.built_in),
    )
    contact_schedules: tuple[ContactSchedule, ...] = declared(
        "what each contact may carry, for the generator of force bounds",
        (),
        read=read_schedules,
        schema=lambda schema: {"type": "array", "items": schema.record(ScheduleFields)},
    )
    joint_limit_schedules: tuple[LimitSchedule, ...] = declared(
        "where joints may be [rad], for the generator of joint limits",
        (),
        read=read_limits,
        schema=lambda schema: {"type": "array", "items": schema.record(LimitFields)},
    )
    torque_limit_schedules: tuple[LimitSchedule, ...] = declared(
        "what motors may give [Nm], for the generator of torque limits",
        (),
        read=read_limits,
        schema=lambda schema: {"type": "array", "items": schema.record(LimitFields)},
    )
    events: tuple[Event, ...] = declared(
        "jumps whose cost is compared without and with generators", ()
    )
    raw_bounds_only: bool = declared(
        "a way of its own to be smooth: never run with generators on", False
    )
    watched_joints: tuple[str, ...] = declared("whose torques the comparison of ways looks at", ())
    standing_height: float | None = declared(
        "of a floating base at the end; left out = as at the start",
        None,
        unit="m",
        domain=NOT_NEGATIVE,
    )
    paper: Mapping[str, Any] = declared("what the paper says, copied into the summary", dict)
    file: Path = Path()
    variant: str = ""  # "" when the file has no variants
    variants: tuple[str, ...] = ()  # all names in the file, the default one first

    def schedules(self) -> Mapping[str, tuple[LimitSchedule, ...]]:
        """Topic -> what goes there before time runs; without those that are empty."""
        found = {topic: getattr(self, section) for section, topic in SECTIONS.items()}
        return {topic: schedules for topic, schedules in found.items() if schedules}

    def __post_init__(self) -> None:
        """Raise InvalidField for events that do not follow each other."""
        for k, (before, after) in enumerate(zip(self.events, self.events[1:], strict=False)):
            if after.time <= before.time:
                raise InvalidField(
                    f"events[{k + 1}].time",
                    f"more than {before.time:g} expected, {after.time:g} given",
                )
