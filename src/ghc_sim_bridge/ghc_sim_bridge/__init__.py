"""MuJoCo behind ROS 2 topics, and the experiments that run on them."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

import ghc_controller  # noqa: F401  (it answers for modules that have moved)

if TYPE_CHECKING:
    from ghc_sim_bridge.errors import SimulationDiverged as SimulationDiverged
    from ghc_sim_bridge.scene.description import load_scene as load_scene
    from ghc_sim_bridge.simulation.simulator import Simulator as Simulator

_HOMES = {
    "SimulationDiverged": "errors",
    "Simulator": "simulation.simulator",
    "load_scene": "scene.description",
}
__all__ = [*_HOMES]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value  # the next use costs no look-up
    return value
