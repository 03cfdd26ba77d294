"""Sections of a scenario with node parameters: by node, and by formulation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ghc_controller.formulations import FORMULATIONS
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.ros.shares.parameters import PriorityShareParameters
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.settings import Settings
from ghc_mpc_constraints.generator import GENERATORS
from ghc_mpc_constraints.ros.parameters import generator_parameters
from ghc_sim_bridge.parameters import BridgeParameters, RecorderParameters, ViewerParameters

CHECKED: Mapping[str, type] = {
    "sim_bridge": BridgeParameters,
    "controller": ControllerParameters,
    "recorder": RecorderParameters,
    "viewer": ViewerParameters,
    "priority_share": PriorityShareParameters,
    **{name: generator_parameters(name) for name in GENERATORS.built_in},
}
NODES = ("sim_bridge", "controller", "recorder", "viewer")  # in addition to generators
SHARE_NODE = "priority_share"  # started where the scenario has a section of this name


def read_parameters(scenario: Fields, name: str) -> Mapping[str, Mapping[str, Any]]:
    """Node -> its parameters, with the checks of the node."""
    fields = scenario.section(name, optional=True)
    for node in fields.given():
        if node not in NODES and node not in GENERATORS:
            known = ", ".join((*NODES, *GENERATORS))
            raise fields.error(node, f"unknown node; known: {known}")
        read(fields.section(node), CHECKED.get(node) or generator_parameters(node))
    return {node: fields.section(node).values for node in fields.given()}


def read_share(scenario: Fields, name: str) -> Mapping[str, Any]:
    """Parameters of priority_share, with the checks of the node; empty without the section."""
    if not scenario.has(name):
        return {}
    fields = scenario.section(name)
    read(fields, PriorityShareParameters)
    for needed in ("first", "second", "task", "begins", "ends"):
        fields.value(needed)  # the node would reject the default
    return fields.values


def read_formulations(scenario: Fields, name: str) -> Mapping[str, Mapping[str, Any]]:
    """Formulation -> parameters of the controller."""
    fields = scenario.section(name, optional=True)
    for formulation in fields.given():
        if formulation not in FORMULATIONS:
            known = ", ".join(FORMULATIONS)
            raise fields.error(formulation, f"unknown formulation; known: {known}")
        in_use = ControllerParameters(settings=Settings(formulation=formulation))
        read(fields.section(formulation), ControllerParameters, base=in_use)
    return {formulation: fields.section(formulation).values for formulation in fields.given()}
