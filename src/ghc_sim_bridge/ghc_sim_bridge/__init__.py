"""MuJoCo behind ROS 2 topics, and the experiments that run on them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ghc_controller.migration.public_names import load_name

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
    return load_name(__name__, _HOMES, name)
