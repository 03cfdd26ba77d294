"""Declared fields of a scenario file, which defines one experiment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
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
from ghc_sim_bridge.scenario.node_sections import (
    NODES,
    SHARE_NODE,
    read_formulations,
    read_parameters,
    read_share,
)
from ghc_sim_bridge.scenario.phase import Phase
from ghc_sim_bridge.scenario.references import Reference, ReferenceFields, read_references
from ghc_sim_bridge.scenario.schedules import (
    SECTIONS,
    Event,
    LimitFields,
    MarginFields,
    ScheduleFields,
    read_generators,
    read_schedules,
)
from ghc_sim_bridge.scenario.walk.walk import Walk


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """One experiment, ready for planning; the last three fields are not in the file."""

    name: str = declared("folder below results/; empty = name of the file", "")
    title: str = declared("title in tables")
    robot: str = declared("name of a robot, or path relative to the working directory")
    scene: str = declared("name of a scene, or path relative to the working directory")
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
    priority_share: Mapping[str, Any] = declared(
        "parameters of a node priority_share, which is then started: two orders, the second one "
        "by the error of a task",
        dict,
        read=read_share,
        schema=lambda schema: schema.parameters_of(SHARE_NODE),
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
        "force bounds of each contact over time, for the generator of force bounds",
        (),
        read=partial(read_schedules, entry=ScheduleFields),
        schema=lambda schema: {"type": "array", "items": schema.record(ScheduleFields)},
    )
    joint_limit_schedules: tuple[LimitSchedule, ...] = declared(
        "position limits over time [rad], for the generator of joint limits",
        (),
        read=partial(read_schedules, entry=LimitFields),
        schema=lambda schema: {"type": "array", "items": schema.record(LimitFields)},
    )
    torque_limit_schedules: tuple[LimitSchedule, ...] = declared(
        "torque limits over time [Nm], for the generator of torque limits",
        (),
        read=partial(read_schedules, entry=LimitFields),
        schema=lambda schema: {"type": "array", "items": schema.record(LimitFields)},
    )
    body_margin_schedules: tuple[LimitSchedule, ...] = declared(
        "margins between bodies over time [m], for the generator of margins",
        (),
        read=partial(read_schedules, entry=MarginFields),
        schema=lambda schema: {"type": "array", "items": schema.record(MarginFields)},
    )
    events: tuple[Event, ...] = declared("events around which torque rates are compared", ())
    raw_bounds_only: bool = declared(
        "this variant always runs with raw bounds, without generators", False
    )
    watched_joints: tuple[str, ...] = declared(
        "joints whose torques are compared over all variants", ()
    )
    standing_height: float | None = declared(
        "of a floating base at the end; left out = as at the start",
        None,
        unit="m",
        domain=NOT_NEGATIVE,
    )
    paper: Mapping[str, Any] = declared("figures of a paper, copied into the summary", dict)
    file: Path = Path()
    variant: str = ""  # "" when the file has no variants
    variants: tuple[str, ...] = ()  # all names in the file, the default one first

    def schedules(self) -> Mapping[str, tuple[LimitSchedule, ...]]:
        """Topic -> schedules sent before time runs; topics without schedules are omitted."""
        found = {topic: getattr(self, section) for section, topic in SECTIONS.items()}
        return {topic: schedules for topic, schedules in found.items() if schedules}

    def __post_init__(self) -> None:
        """Raise InvalidField for events with times that do not increase."""
        for k, (before, after) in enumerate(zip(self.events, self.events[1:], strict=False)):
            if after.time <= before.time:
                raise InvalidField(
                    f"events[{k + 1}].time",
                    f"more than {before.time:g} expected, {after.time:g} given",
                )
