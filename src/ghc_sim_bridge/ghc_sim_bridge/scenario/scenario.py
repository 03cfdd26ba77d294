"""Scenarios as data: what one experiment runs, read from a YAML file.

A scenario names the robot, the scene, the formulation, the task references and the sequence of
hierarchies. `variants` change fields under a name: mappings merge at any depth, lists and values
replace, null takes a field away. Files in the package's folder
`scenario/data/` are found by name; a path finds any other file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Any

from ghc_controller.errors import InvalidField, UnknownName
from ghc_controller.formulations import DEFAULT_FORMULATION, FORMULATIONS
from ghc_controller.registry import Registry
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE, SHARE, Range
from ghc_controller.schema.merging import merged
from ghc_controller.schema.plugged_files import Files, plugged_file
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.schema.record import read
from ghc_controller.types import CONTROL_DT
from ghc_mpc_constraints.generators import GENERATORS
from ghc_sim_bridge.scenario.keyframes import Keyframes
from ghc_sim_bridge.scenario.references import Reference, ReferenceFields, read_references
from ghc_sim_bridge.scenario.schedules import (
    Event,
    ScheduleFields,
    ScriptedSchedule,
    generator_parameters,
    read_generators,
    read_schedules,
)
from ghc_sim_bridge.scenario.walk.walk import (
    Walk,
    walk_events,
    walk_references,
    walk_schedules,
)

_AS_SCENARIO = -1.0  # [s] a hold that no file can give

CHECKED: Mapping[str, type] = {
    "controller": ControllerParameters,
    **{name: generator_parameters(name) for name in GENERATORS.built_in},
}
NODES = ("sim_bridge", "controller", "recorder", "viewer")  # and the generators

SCENARIOS: Registry[Files] = Registry("scenario", "ghc_sim_bridge.scenarios")
for _file in sorted(
    (Path(str(resources.files("ghc_sim_bridge"))) / "scenario" / "data").glob("*.yaml")
):
    SCENARIOS.register(_file.stem)(_file)


@dataclass(frozen=True, slots=True)
class PriorityTable:
    """A priority matrix with the names of its rows and columns."""

    tasks: tuple[str, ...]  # k names
    alpha: tuple[tuple[float, ...], ...]  # (k, k) [-]; alpha[i][j] = 1: j strictly before i


def _read_alpha(fields: Fields, name: str) -> tuple[tuple[float, ...], ...]:
    if not fields.has(name):
        return ()
    size = len(fields.names("tasks", of="task names"))
    rows = fields.value(name)
    if not isinstance(rows, list) or len(rows) != size:
        given = len(rows) if isinstance(rows, list) else repr(rows)
        raise fields.error(name, f"{size} rows (one per task) expected, {given} given")
    alpha = fields.vectors(name, size)
    for k, row in enumerate(alpha):
        if min(row) < 0.0 or max(row) > 1.0:
            raise fields.error(f"{name}[{k}]", f"numbers in [0, 1] expected, {list(row)} given")
    return alpha


def _read_parameters(scenario: Fields, name: str) -> Mapping[str, Mapping[str, Any]]:
    """Node -> its parameters; those of controller and generators are checked here."""
    fields = scenario.section(name, optional=True)
    for node in fields.given():
        if node not in NODES and node not in GENERATORS:
            known = ", ".join((*NODES, *GENERATORS))
            raise fields.error(node, f"unknown node; known: {known}")
        if node in CHECKED or node in GENERATORS:
            read(fields.section(node), CHECKED.get(node) or generator_parameters(node))
    return {node: fields.section(node).values for node in fields.given()}


def _read_formulations(scenario: Fields, name: str) -> Mapping[str, Mapping[str, Any]]:
    """Formulation -> parameters of the controller."""
    fields = scenario.section(name, optional=True)
    for formulation in fields.given():
        if formulation not in FORMULATIONS:
            known = ", ".join(FORMULATIONS)
            raise fields.error(formulation, f"unknown formulation; known: {known}")
        read(fields.section(formulation), ControllerParameters)
    return {formulation: fields.section(formulation).values for formulation in fields.given()}


@dataclass(frozen=True, slots=True)
class Phase:
    """A hierarchy and how long it is held after its transition."""

    hierarchy: str = declared(
        "such as 'end_effector > elbow'; with alpha the text that is shown", ""
    )
    hold: float = declared(
        "after the transition; left out = of the scenario",
        _AS_SCENARIO,
        unit="s",
        domain=NOT_NEGATIVE,
    )
    tasks: tuple[str, ...] = declared("rows and columns of alpha", (), of="task names")
    alpha: tuple[tuple[float, ...], ...] = declared(
        "priority matrix instead of a hierarchy; alpha[i][j] = 1: j strictly before i",
        (),
        unit="-",
        read=_read_alpha,
        schema=lambda schema: schema.rows_of(SHARE),
    )
    paper: Mapping[str, Any] = declared("the paper's figures for this phase", dict)

    def __post_init__(self) -> None:
        """Raise InvalidField for a phase without priorities."""
        if self.tasks and not self.alpha:
            raise InvalidField("alpha", "missing; tasks are given")
        if not self.hierarchy:
            if not self.alpha:
                raise InvalidField("hierarchy", "missing, and no alpha in its place")
            object.__setattr__(self, "hierarchy", f"alpha of {', '.join(self.tasks)}")

    @property
    def table(self) -> PriorityTable | None:
        """What is used in place of the hierarchy string."""
        return PriorityTable(self.tasks, self.alpha) if self.alpha else None


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
        read=_read_parameters,
        schema=lambda schema: schema.node_parameters((*NODES, *GENERATORS.built_in)),
    )
    formulation_parameters: Mapping[str, Mapping[str, Any]] = declared(
        "formulation: further parameters of the controller with it",
        dict,
        read=_read_formulations,
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
    contact_schedules: tuple[ScriptedSchedule, ...] = declared(
        "what each contact may carry, for the generator of force bounds",
        (),
        read=read_schedules,
        schema=lambda schema: {"type": "array", "items": schema.record(ScheduleFields)},
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

    def __post_init__(self) -> None:
        """Raise InvalidField for events that do not follow each other."""
        for k, (before, after) in enumerate(zip(self.events, self.events[1:], strict=False)):
            if after.time <= before.time:
                raise InvalidField(
                    f"events[{k + 1}].time",
                    f"more than {before.time:g} expected, {after.time:g} given",
                )


def scenario_names() -> tuple[str, ...]:
    """Names of the scenarios of this and other packages, sorted."""
    return tuple(SCENARIOS)


def find_scenario(name: str) -> Path:
    """File of a scenario, by its name or by a path that ends in .yaml.

    Raises UnknownName with the existing names, or PluginError.
    """
    if name.endswith(".yaml") and Path(name).is_file():
        return Path(name)
    return plugged_file(SCENARIOS[name], f"{name}.yaml")


def load_scenario(name: str, variant: str = "") -> Scenario:
    """Scenario by name or path; `variant` "" is the first one of the file.

    Raises UnknownName (scenario, variant) or ConfigurationError (file, field, what was given).
    """
    file = find_scenario(name)
    fields = read_yaml(file)
    variants = fields.section("variants", optional=True)
    names = variants.given()
    if variant and variant not in names:
        raise UnknownName(f"variant of scenario '{name}'", variant, names)
    chosen = variant or (names[0] if names else "")
    changes = variants.section(chosen).values if chosen else {}
    common = {key: value for key, value in fields.values.items() if key != "variants"}
    return _read_scenario(Fields(merged(common, changes), file), file, chosen, names)


def _beside(name: str, file: Path) -> str:
    """A path that begins with "." is meant from the scenario's file."""
    return str((file.parent / name).resolve()) if name.startswith(".") else name


def _read_scenario(
    fields: Fields, file: Path, variant: str, variants: tuple[str, ...]
) -> Scenario:
    given = read(fields, Scenario)
    scenario = replace(
        given,
        name=given.name or file.stem,
        robot=_beside(given.robot, file),
        scene=_beside(given.scene, file),
        phases=tuple(
            phase if phase.hold != _AS_SCENARIO else replace(phase, hold=given.hold)
            for phase in given.phases
        ),
        file=file,
        variant=variant,
        variants=variants,
    )
    walk = scenario.walk
    if walk is not None:
        events = (*scenario.events, *walk_events(walk))
        scenario = replace(
            scenario,
            references=(*scenario.references, *walk_references(walk)),
            contact_schedules=(*scenario.contact_schedules, *walk_schedules(walk)),
            events=tuple(sorted(events, key=lambda event: event.time)),
        )
    if scenario.contact_schedules and not any(
        GENERATORS[generator].reads_schedules for generator in scenario.generators
    ):
        raise fields.error(
            "contact_schedules", "nobody reads them: generators has no contact_force_bounds"
        )
    return scenario
