"""Finds scenarios by name or path, and reads their YAML files.

A scenario defines the robot, the scene, the formulation, the task references and the sequence of
hierarchies. Named `variants` change fields: mappings merge at any depth, lists and values are
replaced, null removes a field. Files in `scenario/data/` of the package are found by name, all
others by path.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ghc_controller.errors import InvalidField, UnknownName
from ghc_controller.registry import Registry
from ghc_controller.schema.merging import merged
from ghc_controller.schema.plugged_files import Files, plugged_file
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.schema.record import read
from ghc_mpc_constraints.generator import GENERATORS
from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.phase import AS_SCENARIO
from ghc_sim_bridge.scenario.schedules import SECTIONS
from ghc_sim_bridge.scenario.walk.walk import walk_events, walk_references, walk_schedules

SCENARIOS: Registry[Files] = Registry("scenario", "ghc_sim_bridge.scenarios")
SCENARIOS.register_files("ghc_sim_bridge", "scenario/data/*.yaml")


def scenario_names() -> tuple[str, ...]:
    """Sorted names of the scenarios of this package and of plug-ins."""
    return tuple(SCENARIOS)


def find_scenario(name: str) -> Path:
    """File of a scenario, by its name or a path that ends in .yaml.

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
    """Paths that begin with "." are relative to the scenario's file."""
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
            phase if phase.hold != AS_SCENARIO else replace(phase, hold=given.hold)
            for phase in given.phases
        ),
        file=file,
        variant=variant,
        variants=variants,
    )
    try:
        scenario = _with_walk(scenario)
    except InvalidField as error:
        raise fields.error(error.field, error.problem) from error
    read_topics = {GENERATORS[generator].input.topic for generator in scenario.generators}
    for section, topic in SECTIONS.items():
        if topic in scenario.schedules() and topic not in read_topics:
            readers = [
                name for name, kind in GENERATORS.usable().items() if kind.input.topic == topic
            ]
            raise fields.error(
                section, f"nobody reads them: generators has none of {', '.join(readers)}"
            )
    return scenario


def _with_walk(scenario: Scenario) -> Scenario:
    """The scenario with the references, schedules and events of its walk added.

    Raises InvalidField for an event at the same time as one of the walk.
    """
    walk = scenario.walk
    if walk is None:
        return scenario
    events = (*scenario.events, *walk_events(walk))
    return replace(
        scenario,
        references=(*scenario.references, *walk_references(walk)),
        contact_schedules=(*scenario.contact_schedules, *walk_schedules(walk)),
        events=tuple(sorted(events, key=lambda event: event.time)),
    )
