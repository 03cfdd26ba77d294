"""Parameters of all nodes of a run, from its scenario and options."""

from __future__ import annotations

import math
from typing import Any

from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.schema.declared import flat
from ghc_mpc_constraints.generator import GENERATORS
from ghc_mpc_constraints.ros.parameters import generator_parameters
from ghc_sim_bridge.scenario.node_sections import SHARE_NODE
from ghc_sim_bridge.scenario.plan import RunPlan
from ghc_sim_bridge.scenario.schedules import reads_schedules
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.simulation.timing import PHYSICS_DT


def node_parameters(plan: RunPlan) -> dict[str, dict[str, Any]]:
    """Node -> parameter -> value, for every node that the run starts.

    Raises UnknownName (an option for a node that is not in this run) or InvalidValue (generators
    with different steps).
    """
    scenario, folder = plan.scenario, plan.folder
    nodes: dict[str, dict[str, Any]] = {
        "sim_bridge": {
            "scene": scenario.scene,
            "mode": plan.options.mode,
            "control_dt": plan.control_dt,
            "physics_dt": plan.control_dt / math.ceil(plan.control_dt / PHYSICS_DT - 1e-9),
            "stop_time": plan.duration,
            "paused": True,
            "lossless": plan.options.record == "full",
            "log_file": str(folder / "log.npz"),
            "torque_rate_limit": scenario.torque_rate_limit,
        },
        "controller": {
            "robot": scenario.robot,
            "formulation": plan.formulation,
            "control_dt": plan.control_dt,
            "torque_rate_limit": scenario.torque_rate_limit,
            "lockstep": plan.options.mode == "lockstep",
            "arming": "automatic",  # start with the first state
        },
        "recorder": {
            "output": str(folder / "recording"),
            "record_mode": plan.options.record,
        },
        "viewer": {"scene": scenario.scene, "robot": scenario.robot},
    }
    if plan.phases[0].phase.table is None:
        nodes["controller"]["hierarchy"] = plan.phases[0].phase.hierarchy
    if not plan.options.view:
        del nodes["viewer"]
    nodes |= _generator_parameters(plan)
    if scenario.priority_share:
        nodes[SHARE_NODE] = dict(scenario.priority_share)
    nodes["controller"] |= _waiting_for(plan)
    for node, values in scenario.parameters.items():
        if node in nodes:
            nodes[node].update(values)
    nodes["controller"].update(scenario.formulation_parameters.get(plan.formulation, {}))
    for node, name, value in plan.options.parameters:
        if node not in nodes:
            raise UnknownName("node of this run", node, nodes)
        known = nodes[node].get(name)
        nodes[node][name] = float(value) if _is_float_for(known, value) else value
    return nodes


def _generator_parameters(plan: RunPlan) -> dict[str, dict[str, Any]]:
    """Parameters of the generators of this run, in start order."""
    scenario = plan.scenario
    lockstep = plan.options.mode == "lockstep"
    nodes: dict[str, dict[str, Any]] = {}
    for name in scenario.generators:
        nodes[name] = {"generator": name, "smoothing": plan.options.generators is not False}
        if reads_schedules(name):
            nodes[name]["lockstep"] = lockstep
        elif lockstep:
            # Ticks at multiples of the sensor's period wait for its measurement.
            nodes[name]["sensor_period"] = load_scene(scenario.scene).sensor_period or 0.0
        if any(entry.name == "robot" for entry in flat(generator_parameters(name))):
            nodes[name]["robot"] = scenario.robot
        nodes[name].update(scenario.generators[name])
    return nodes


def _waiting_for(plan: RunPlan) -> dict[str, Any]:
    """Parameters of the controller for the generators of this run."""
    generators = plan.scenario.generators
    if not generators or plan.options.mode != "lockstep":
        return {}
    steps = {float(values["step"]) for values in generators.values() if "step" in values}
    if len(steps) > 1:
        raise InvalidValue(f"generators of '{plan.scenario.name}': one step expected, {steps}")
    waiting: dict[str, Any] = {"wait_for_bounds": [GENERATORS[name].kind for name in generators]}
    return waiting | ({"bounds_step": steps.pop()} if steps else {})


def _is_float_for(known: object, value: object) -> bool:
    return isinstance(known, float) and isinstance(value, int) and not isinstance(value, bool)
