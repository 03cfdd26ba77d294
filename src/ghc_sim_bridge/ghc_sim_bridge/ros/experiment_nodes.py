"""The processes of a run: their executables and the topics they subscribe to before time runs."""

from __future__ import annotations

from ghc_mpc_constraints.generator import GENERATORS
from ghc_sim_bridge.ros.experiment_client import (
    REFERENCE_TOPIC,
    REPORT_TOPIC,
    STATE_TOPIC,
    TICK_TOPIC,
    TRANSITION_TOPIC,
)

_SCRIPT = (REFERENCE_TOPIC, TRANSITION_TOPIC)

# Node -> (package, executable).
_EXECUTABLES = {
    "sim_bridge": ("ghc_sim_bridge", "sim_bridge"),
    "controller": ("ghc_controller", "controller"),
    "recorder": ("ghc_sim_bridge", "recorder"),
    "viewer": ("ghc_sim_bridge", "viewer"),
    "priority_share": ("ghc_controller", "priority_share"),
}
_READ_BEFORE_START = {
    "controller": _SCRIPT,
    "recorder": (*_SCRIPT, STATE_TOPIC, REPORT_TOPIC),
    "viewer": (STATE_TOPIC,),
    "priority_share": (REPORT_TOPIC,),
}
MAY_END = ("viewer",)  # the user may close the window


def executable_of(node: str) -> tuple[str, str]:
    """Package and executable of a node of a run."""
    if node in _EXECUTABLES:
        return _EXECUTABLES[node]
    return "ghc_mpc_constraints", "generator"


def read_before_start(node: str) -> tuple[str, ...]:
    """Topics to which a node has to subscribe before anything is sent."""
    if node in _EXECUTABLES:
        return _READ_BEFORE_START.get(node, ())
    return TICK_TOPIC, GENERATORS[node].input.topic
