"""Scenarios as data: what one experiment runs, read from a YAML file.

A scenario names the robot, the scene, the formulation, the task references and the sequence of
hierarchies. `variants` override top-level fields under a name. Files in the package's folder
`scenario/data/` are found by name; a path finds any other file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from ghc_controller.errors import UnknownName
from ghc_controller.formulations import DEFAULT_FORMULATION, FORMULATIONS
from ghc_controller.registry import Registry
from ghc_controller.schema.plugged_files import Files, plugged_file
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_mpc_constraints.generators import GENERATORS
from ghc_sim_bridge.scenario.keyframes import Keyframes, read_keyframes
from ghc_sim_bridge.scenario.references import Reference, read_reference
from ghc_sim_bridge.scenario.schedules import (
    Event,
    ScriptedSchedule,
    read_events,
    read_generators,
    read_schedule,
)
from ghc_sim_bridge.scenario.walk.fields import read_walk
from ghc_sim_bridge.scenario.walk.walk import walk_events, walk_references, walk_schedules

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
    torque_rate: float  # [Nm/s] budget of each ramp; 0 = none
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
    merged = {key: value for key, value in fields.values.items() if key != "variants"} | changes
    return _read_scenario(Fields(merged, file), file, chosen, names)


def _read_scenario(
    fields: Fields, file: Path, variant: str, variants: tuple[str, ...]
) -> Scenario:
    scripted = fields.section("references", optional=True)
    references = tuple(read_reference(task, scripted.section(task)) for task in scripted.given())
    hold = fields.number("hold", 8.0, minimum=0.0)
    phases = tuple(_read_phase(item, hold) for item in fields.sections("phases"))
    parameters = fields.section("parameters", optional=True)
    for node in parameters.given():
        if node not in NODES and node not in GENERATORS:
            known = ", ".join((*NODES, *GENERATORS))
            raise parameters.error(node, f"unknown node; known: {known}")
    generators = read_generators(fields.section("generators", optional=True))
    schedules = tuple(
        read_schedule(item) for item in fields.sections("contact_schedules", optional=True)
    )
    events = read_events(fields)
    if fields.has("walk"):
        walk = read_walk(fields.section("walk"))
        references = (*references, *walk_references(walk))
        schedules = (*schedules, *walk_schedules(walk))
        events = tuple(sorted((*events, *walk_events(walk)), key=lambda event: event.time))
    if schedules and not any(GENERATORS[name].reads_schedules for name in generators):
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
        formulation=fields.text("formulation", DEFAULT_FORMULATION),
        control_dt=fields.number("control_dt", 1e-3, minimum=1e-6),
        transition=fields.number("transition", 2.0, minimum=0.0),
        torque_rate=fields.number("torque_rate", 0.0, minimum=0.0),
        torque_rate_limit=fields.number("torque_rate_limit", minimum=0.0),
        references=references,
        keyframes=_optional_keyframes(fields),
        phases=phases,
        parameters={node: parameters.section(node).values for node in parameters.given()},
        formulation_parameters=_read_formulations(
            fields.section("formulation_parameters", optional=True)
        ),
        robot_changes=fields.section("robot_changes", optional=True).values,
        generators=generators,
        contact_schedules=schedules,
        events=events,
        raw_bounds_only=fields.flag("raw_bounds_only", False),
        watched_joints=fields.names("watched_joints", optional=True),
        paper=fields.section("paper", optional=True).values,
        standing_height=(
            fields.number("standing_height", minimum=0.0)
            if fields.has("standing_height")
            else None
        ),
    )
    fields.done()
    return scenario


def _optional_keyframes(fields: Fields) -> Keyframes | None:
    return read_keyframes(fields.section("keyframes")) if fields.has("keyframes") else None


def _read_formulations(fields: Fields) -> Mapping[str, Mapping[str, Any]]:
    for name in fields.given():
        if name not in FORMULATIONS:
            raise fields.error(name, f"unknown formulation; known: {', '.join(FORMULATIONS)}")
    return {name: fields.section(name).values for name in fields.given()}


def _read_phase(fields: Fields, default_hold: float) -> Phase:
    table = None
    if fields.has("alpha"):
        table = _read_table(fields)
        hierarchy = fields.text("hierarchy", f"alpha of {', '.join(table.tasks)}")
    else:
        hierarchy = fields.text("hierarchy")
    hold = fields.number("hold", default_hold, minimum=0.0)
    paper = fields.value("paper", {})
    fields.done()
    return Phase(hierarchy, hold, table, paper)


def _read_table(fields: Fields) -> PriorityTable:
    tasks = fields.names("tasks", of="task names")
    rows = fields.value("alpha")
    size = len(tasks)
    if not isinstance(rows, list) or len(rows) != size:
        given = len(rows) if isinstance(rows, list) else repr(rows)
        raise fields.error("alpha", f"{size} rows (one per task) expected, {given} given")
    alpha = fields.vectors("alpha", size)
    for k, row in enumerate(alpha):
        if min(row) < 0.0 or max(row) > 1.0:
            raise fields.error(f"alpha[{k}]", f"numbers in [0, 1] expected, {list(row)} given")
    return PriorityTable(tasks, alpha)
