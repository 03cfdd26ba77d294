"""The processes of a run: where their executables are, and what they read before time runs."""

from __future__ import annotations

from ghc_sim_bridge.ros.experiment_client import (
    OBSTACLE_TOPIC,
    REFERENCE_TOPIC,
    REPORT_TOPIC,
    SCHEDULE_TOPIC,
    STATE_TOPIC,
    TICK_TOPIC,
    TRANSITION_TOPIC,
)

_SCRIPT = (REFERENCE_TOPIC, TRANSITION_TOPIC)
_GENERATORS = "ghc_mpc_constraints"  # named, not imported: that package builds on this one

# Node -> (package, executable).
EXECUTABLES = {
    "sim_bridge": ("ghc_sim_bridge", "sim_bridge"),
    "controller": ("ghc_controller", "controller"),
    "recorder": ("ghc_sim_bridge", "recorder"),
    "viewer": ("ghc_sim_bridge", "viewer"),
    "contact_force_bounds": (_GENERATORS, "contact_force_bounds"),
    "obstacle_bounds": (_GENERATORS, "obstacle_bounds"),
}
# Node -> topics to which it has to subscribe before anything is sent.
READ_BEFORE_START = {
    "controller": _SCRIPT,
    "recorder": (*_SCRIPT, STATE_TOPIC, REPORT_TOPIC),
    "viewer": (STATE_TOPIC,),
    "contact_force_bounds": (TICK_TOPIC, SCHEDULE_TOPIC),
    "obstacle_bounds": (TICK_TOPIC, OBSTACLE_TOPIC),
}
MAY_END = ("viewer",)  # whoever watches may close the window
