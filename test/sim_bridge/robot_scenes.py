"""The scenes of the package by what their robot is; those whose model is missing are skipped."""

from __future__ import annotations

from typing import Any

import pytest

from ghc_controller.errors import ConfigurationError
from ghc_sim_bridge.scene_description import SceneDescription, list_scenes, load_scene


def _loaded(name: str) -> SceneDescription | str:
    try:
        return load_scene(name)
    except ConfigurationError as error:
        if "is not installed" not in str(error):
            raise
        return str(error)


def _parameters(floating: bool) -> list[Any]:
    result = []
    for name in list_scenes():
        scene = _loaded(name)
        if isinstance(scene, str):  # whether its base floats is not known then
            result.append(pytest.param(name, marks=pytest.mark.skip(reason=scene)))
        elif (scene.base is not None) == floating:
            result.append(pytest.param(name))
    return result


FIXED_SCENES = _parameters(floating=False)
FLOATING_SCENES = _parameters(floating=True)
