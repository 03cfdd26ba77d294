"""Scenarios as data: what one experiment runs, read from a YAML file.

A scenario names the robot, the scene, the formulation, the task references and the sequence of
hierarchies. `variants` override top-level fields under a name. Files in the package's folder
`scenarios/` are found by name; a path finds any other file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from ghc_controller.errors import UnknownName
from ghc_controller.formulations import FORMULATIONS
from ghc_sim_bridge.generator_script import (
    GENERATORS,
    Event,
    ScriptedSchedule,
    read_events,
    read_generators,
    read_schedule,
)
from ghc_sim_bridge.keyframes import Keyframes, read_keyframes
from ghc_sim_bridge.references import Reference, read_reference
from ghc_sim_bridge.walk import walk_events, walk_references, walk_schedules
from ghc_sim_bridge.walk_fields import read_walk
from ghc_sim_bridge.yaml_fields import Fields, read_yaml

NODES = ("sim_bridge", "controller", "recorder", "viewer", *GENERATORS)


@dataclass(frozen=True, slots=True)
class PriorityTable:
    """A priority matrix with the names of its rows and columns."""

    tasks: tuple[str, ...]  # k names
    alpha: tuple[tuple[float, ...], ...]  # (k, k) [-]; alpha[i][j] = 1: j strictly before i


@dataclass(frozen=True, slots=True)
class Phase:
    """A hierarchy and how long it is held after its transition."""

    hierarchy: str  # e.g. "end_effector > elbow > posture"; the text shown when a table is given
    hold: float  # [s] after the transition
    table: PriorityTable | None = None  # used in place of the hierarchy string
    paper: Mapping[str, Any] | None = None  # the paper's figures for this phase


@dataclass(frozen=True, slots=True)
class Scenario:
    """One experiment, ready to be planned."""

    name: str
    title: str
    file: Path
    variant: str  # "" when the file has no variants
    variants: tuple[str, ...]  # all names in the file, the default one first
    robot: str
    scene: str
    formulation: str
    control_dt: float  # [s]
    transition: float  # [s] duration of each ramp
    torque_rate_limit: float  # [Nm/s] controller and bridge; 0 = off
    references: tuple[Reference, ...]
    keyframes: Keyframes | None  # more references, as postures of the whole body
    phases: tuple[Phase, ...]
    parameters: Mapping[str, Mapping[str, Any]]  # node -> parameter -> value
    formulation_parameters: Mapping[str, Mapping[str, Any]]  # formulation -> of the controller
    robot_changes: Mapping[str, Any]  # merged into the robot's YAML
    generators: Mapping[str, Mapping[str, Any]]  # node -> parameter -> value; empty = none
    contact_schedules: tuple[ScriptedSchedule, ...]  # for the generator of force bounds
    events: tuple[Event, ...]  # jumps whose cost is compared without and with generators
    raw_bounds_only: bool  # a way of its own to be smooth: never run with generators on
    watched_joints: tuple[str, ...]  # whose torques the comparison of ways looks at; empty = none
    paper: Mapping[str, Any]  # what the paper says, copied into the summary
    standing_height: float | None = (
        None  # [m] of a floating base at the end; None = as at the start
    )


def scenario_names() -> tuple[str, ...]:
    """Names of the scenarios of this package, sorted."""
    folder = resources.files("ghc_sim_bridge") / "scenarios"
    files = [Path(entry.name) for entry in folder.iterdir()]
    return tuple(sorted(file.stem for file in files if file.suffix == ".yaml"))


def find_scenario(name: str) -> Path:
    """File of a scenario, by its name or by a path that ends in .yaml.

    Raises UnknownName with the existing names.
    """
    if name.endswith(".yaml") and Path(name).is_file():
        return Path(name)
    if name not in scenario_names():
        raise UnknownName("scenario", name, scenario_names())
    return Path(str(resources.files("ghc_sim_bridge") / "scenarios" / f"{name}.yaml"))


def load_scenario(name: str, variant: str = "") -> Scenario:
    """Scenario by name or path; `variant` "" is the first one of the file.

    Raises UnknownName (scenario, variant) or ConfigurationError (file, field, what was given).
    """
    file = find_scenario(name)
    data = read_yaml(file)
    variants = Fields(data, file).section("variants", {})
    names = variants.names()
    if variant and variant not in names:
        raise UnknownName(f"variant of scenario '{name}'", variant, names)
    chosen = variant or (names[0] if names else "")
    changes = dict(variants.value(chosen)) if chosen else {}
    merged = {key: value for key, value in data.items() if key != "variants"} | changes
    return _read_scenario(Fields(merged, file), file, chosen, names)


def _read_scenario(
    fields: Fields, file: Path, variant: str, variants: tuple[str, ...]
) -> Scenario:
    scripted = fields.section("references", {})
    references = tuple(read_reference(task, scripted.section(task)) for task in scripted.names())
    hold = fields.number("hold", 8.0, minimum=0.0)
    phases = tuple(_read_phase(item, hold) for item in fields.items("phases"))
    if not phases:
        raise fields.error("phases", "at least one phase is expected, none given")
    parameters = fields.section("parameters", {})
    for node in parameters.names():
        if node not in NODES:
            raise parameters.error(node, f"unknown node; known: {', '.join(NODES)}")
    generators = read_generators(fields.section("generators", {}))
    schedules = tuple(read_schedule(item) for item in fields.items("contact_schedules", ()))
    events = read_events(fields)
    if fields.has("walk"):
        walk = read_walk(fields.section("walk"))
        references = (*references, *walk_references(walk))
        schedules = (*schedules, *walk_schedules(walk))
        events = tuple(sorted((*events, *walk_events(walk)), key=lambda event: event.time))
    if schedules and "contact_force_bounds" not in generators:
        raise fields.error(
            "contact_schedules", "nobody reads them: generators has no contact_force_bounds"
        )
    scenario = Scenario(
        name=fields.text("name", file.stem),
        title=fields.text("title"),
        file=file,
        variant=variant,
        variants=variants,
        robot=fields.text("robot"),
        scene=fields.text("scene"),
        formulation=fields.text("formulation", "balanced"),
        control_dt=fields.number("control_dt", 1e-3, minimum=1e-6),
        transition=fields.number("transition", 2.0, minimum=0.0),
        torque_rate_limit=fields.number("torque_rate_limit", minimum=0.0),
        references=references,
        keyframes=_optional_keyframes(fields),
        phases=phases,
        parameters={node: dict(parameters.value(node)) for node in parameters.names()},
        formulation_parameters=_read_formulations(fields.section("formulation_parameters", {})),
        robot_changes=dict(fields.value("robot_changes", {})),
        generators=generators,
        contact_schedules=schedules,
        events=events,
        raw_bounds_only=_flag(fields, "raw_bounds_only"),
        watched_joints=_names(fields, "watched_joints"),
        paper=dict(fields.value("paper", {})),
        standing_height=(
            fields.number("standing_height", minimum=0.0)
            if fields.has("standing_height")
            else None
        ),
    )
    fields.close()
    return scenario


def _optional_keyframes(fields: Fields) -> Keyframes | None:
    return read_keyframes(fields.section("keyframes")) if fields.has("keyframes") else None


def _flag(fields: Fields, name: str) -> bool:
    value = fields.value(name, False)
    if not isinstance(value, bool):
        raise fields.error(name, f"true or false is expected, {value!r} given")
    return value


def _names(fields: Fields, name: str) -> tuple[str, ...]:
    value = fields.value(name, [])
    if not isinstance(value, list) or not all(isinstance(entry, str) for entry in value):
        raise fields.error(name, f"a list of names is expected, {value!r} given")
    return tuple(value)


def _read_formulations(fields: Fields) -> Mapping[str, Mapping[str, Any]]:
    for name in fields.names():
        if name not in FORMULATIONS:
            raise fields.error(name, f"unknown formulation; known: {', '.join(FORMULATIONS)}")
        if not isinstance(fields.value(name), dict):
            raise fields.error(name, f"a mapping is expected, {fields.value(name)!r} given")
    return {name: fields.value(name) for name in fields.names()}


def _read_phase(fields: Fields, default_hold: float) -> Phase:
    table = None
    if fields.has("alpha"):
        table = _read_table(fields)
        hierarchy = fields.text("hierarchy", f"alpha of {', '.join(table.tasks)}")
    else:
        hierarchy = fields.text("hierarchy")
    hold = fields.number("hold", default_hold, minimum=0.0)
    paper = fields.value("paper", {})
    fields.close()
    return Phase(hierarchy, hold, table, paper)


def _read_table(fields: Fields) -> PriorityTable:
    tasks = fields.value("tasks")
    if not isinstance(tasks, list) or not all(isinstance(task, str) for task in tasks):
        raise fields.error("tasks", f"a list of task names is expected, {tasks!r} given")
    rows = fields.value("alpha")
    size = len(tasks)
    if not isinstance(rows, list) or len(rows) != size:
        given = len(rows) if isinstance(rows, list) else repr(rows)
        raise fields.error("alpha", f"{size} rows (one per task) are expected, {given} given")
    alpha = Fields(
        {str(k): row for k, row in enumerate(rows)}, fields.file, f"{fields.where}.alpha"
    )
    values = tuple(alpha.vector(str(k)) for k in range(size))
    for k, row in enumerate(values):
        if len(row) != size or min(row) < 0.0 or max(row) > 1.0:
            raise alpha.error(str(k), f"{size} numbers in [0, 1] are expected, {list(row)} given")
    return PriorityTable(tuple(tasks), values)
