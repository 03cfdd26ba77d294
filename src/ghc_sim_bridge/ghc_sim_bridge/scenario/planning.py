"""Plans a run from a scenario and command-line options: times, parameters, folders."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from ghc_controller.constraints.rows.body_distance import margin_names
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.formulations import FORMULATIONS, blending_formulations
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_mpc_constraints.generator import GENERATORS
from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.home import results_home
from ghc_sim_bridge.scenario.keyframe_references import keyframe_references
from ghc_sim_bridge.scenario.node_sections import NODES, SHARE_NODE
from ghc_sim_bridge.scenario.parameters import node_parameters
from ghc_sim_bridge.scenario.phase import Phase
from ghc_sim_bridge.scenario.plan import (
    MODES,
    RECORD_MODES,
    PlannedPhase,
    RunOptions,
    RunPlan,
)
from ghc_sim_bridge.scenario.robot_changes import names_of


def parse_parameter(text: str) -> tuple[str, str, Any]:
    """Parse `node:name:=value`: the syntax of `ros2 run` with a leading node name.

    Raises InvalidValue or UnknownName (node).
    """
    target, separator, value = text.partition(":=")
    node, colon, name = target.partition(":")
    if not separator or not colon or not name:
        raise InvalidValue(
            f"--param '{text}': node:name:=value is expected, "
            "e.g. controller:torque_rate_limit:=1000.0"
        )
    nodes = (*NODES, SHARE_NODE)
    if node not in nodes and node not in GENERATORS:
        raise UnknownName("node", node, (*nodes, *GENERATORS))
    try:
        return node, name, yaml.safe_load(value)
    except yaml.YAMLError as error:
        raise InvalidValue(f"--param '{text}': the value is not valid YAML") from error


def make_plan(scenario: Scenario, options: RunOptions, output: Path) -> RunPlan:
    """The run of a scenario under options; `output` is the root of all results.

    `hqp` runs switch at once (a cascade of strict levels has no intermediate state) unless a
    transition is given. Raises InvalidValue (option out of range, or a torque rate with a
    formulation that cannot keep it), UnknownName (formulation, mode, robot, contact of a
    schedule) or ConfigurationError (robot.yaml).
    """
    _check_options(options)
    scenario = _with_keyframes(scenario)
    if options.generators is not None and not scenario.generators:
        raise InvalidValue(
            f"generators {'on' if options.generators else 'off'}: scenario '{scenario.name}' has "
            "no section 'generators'"
        )
    formulation = options.formulation or scenario.formulation
    if formulation not in FORMULATIONS:
        raise UnknownName("formulation", formulation, FORMULATIONS)
    transition = scenario.transition if formulation != "hqp" else 0.0
    if options.transition is not None:
        transition = options.transition
    torque_rate = _torque_rate(scenario, options, formulation)
    control_dt = options.control_dt or scenario.control_dt
    phases = _time_phases(scenario.phases, transition, control_dt)
    folder, is_default = _place(scenario, options, formulation, transition)
    plan = RunPlan(
        scenario=scenario,
        options=options,
        formulation=formulation,
        transition=transition,
        torque_rate=torque_rate,
        control_dt=control_dt,
        phases=phases,
        parameters={},
        folder=results_home(scenario, output) / folder,
        is_default=is_default,
        changes=scenario.robot_changes,
    )
    plan = replace(plan, parameters=node_parameters(plan))
    _check_names(plan)
    return plan


def _with_keyframes(scenario: Scenario) -> Scenario:
    """The scenario with the references of its keyframes added."""
    if scenario.keyframes is None:
        return scenario
    given = {reference.task for reference in scenario.references}
    for task in scenario.keyframes.tasks:
        if task in given:
            raise InvalidValue(f"scenario '{scenario.name}': task '{task}' has two references")
    found = keyframe_references(scenario.keyframes, scenario.robot, scenario.scene)
    return replace(scenario, references=scenario.references + found, keyframes=None)


def _check_names(plan: RunPlan) -> None:
    """Reject schedules of contacts or joints, and references of tasks, that the robot lacks.

    Raises UnknownName, or ConfigurationError for an unreadable robot.yaml.
    """
    scenario = plan.scenario
    scheduled = [schedule.name for schedule in scenario.contact_schedules]
    moved = [reference.task for reference in scenario.references]
    limits = (*scenario.joint_limit_schedules, *scenario.torque_limit_schedules)
    bounded = [schedule.name for schedule in limits]
    margins = [schedule.name for schedule in scenario.body_margin_schedules]
    if not (scheduled or moved or bounded or margins):
        return
    robot = find_robot(str(plan.parameters["controller"]["robot"]))
    contacts = names_of("contacts", robot, plan.changes)
    tasks = names_of("tasks", robot, plan.changes)
    if "urdf" in plan.changes:
        bounded, margins = [], []  # of another model
    config = load_robot_config(robot) if bounded or margins else None
    joints = config.model.joint_names if config else ()
    known_margins = margin_names(config.constraints) if config else ()
    for what, names, known in (
        ("joint in a schedule", bounded, joints),
        ("margin in a schedule", margins, known_margins),
        ("contact in a schedule", scheduled, contacts),
        ("task in a reference", moved, tasks + contacts),  # a contact may have a force task
    ):
        for name in names:
            if name not in known:
                raise UnknownName(f"{what} of scenario '{scenario.name}'", name, known)


def _torque_rate(scenario: Scenario, options: RunOptions, formulation: str) -> float:
    """Budget of the transitions [Nm/s]; InvalidValue if the formulation cannot keep it."""
    rate = scenario.torque_rate if options.torque_rate is None else options.torque_rate
    if rate > 0.0 and not FORMULATIONS[formulation].blends:
        able = ", ".join(blending_formulations())
        raise InvalidValue(
            f"torque rate {rate:g} Nm/s: formulation '{formulation}' cannot keep it, only one "
            f"that blends orders: {able}; torque rate 0 = none"
        )
    return rate


def _check_options(options: RunOptions) -> None:
    if options.transition is not None and not 0.0 <= options.transition < math.inf:
        raise InvalidValue(f"transition {options.transition:g} s: at least 0 is expected")
    if options.torque_rate is not None and not 0.0 <= options.torque_rate < math.inf:
        raise InvalidValue(f"torque rate {options.torque_rate:g} Nm/s: at least 0 is expected")
    if options.control_dt is not None and not 0.0 < options.control_dt < math.inf:
        raise InvalidValue(f"control period {options.control_dt:g} s: more than 0 is expected")
    for value, known, kind in (
        (options.mode, MODES, "mode"),
        (options.record, RECORD_MODES, "record mode"),
    ):
        if value not in known:
            raise UnknownName(kind, value, known)


def _time_phases(
    phases: Sequence[Phase], transition: float, control_dt: float
) -> tuple[PlannedPhase, ...]:
    """Consecutive phases, at multiples of the control period."""
    planned: list[PlannedPhase] = []
    start = 0.0
    for index, phase in enumerate(phases):
        ramp = transition if index else 0.0
        end = _on_grid(start + ramp + phase.hold, control_dt)
        planned.append(PlannedPhase(phase, start, end, ramp))
        start = end
    return tuple(planned)


def _on_grid(time: float, step: float) -> float:
    return round(round(time / step) * step, 9)


def _place(
    scenario: Scenario, options: RunOptions, formulation: str, transition: float
) -> tuple[str, bool]:
    """Folder name of the variant and whether it is the default one."""
    generators = "generators_on" if scenario.generators else ""
    default_transition = 0.0 if formulation == "hqp" else scenario.transition
    parts = [scenario.variant, formulation]
    parts.append("generators_off" if options.generators is False else generators)
    if transition != default_transition:
        parts.append(f"transition_{transition:g}s")
    if options.torque_rate not in (None, scenario.torque_rate):
        parts.append(f"torque_rate_{options.torque_rate:g}")
    if options.control_dt not in (None, scenario.control_dt):
        parts.append(f"dt_{options.control_dt:g}s")
    if options.mode != MODES[0]:
        parts.append(options.mode)
    for node, name, value in options.parameters:
        parts.append(f"{node}.{name}_{value}".replace("/", "_").replace(" ", ""))
    folder = "-".join(part for part in parts if part)
    first = scenario.variants[0] if scenario.variants else ""
    standard = "-".join(part for part in (first, scenario.formulation, generators) if part)
    return folder, folder == standard
