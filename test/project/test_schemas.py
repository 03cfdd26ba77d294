"""The schemas for editors are those of the declarations, and every shipped file is valid."""

from __future__ import annotations

import copy
import json
import math
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from doc_text import ROOT, blocks
from reference.json_schema import problems

from ghc_controller.errors import GhcError
from ghc_controller.robot.library import load_robot
from ghc_controller.settings import Settings
from ghc_controller.tasks import TASKS
from ghc_sim_bridge.scenario.scenario import load_scenario
from ghc_sim_bridge.scene.description import load_scene

FOLDER = ROOT / "schemas"
FILES = {
    "robot": sorted((ROOT / "src/ghc_controller/ghc_controller/robot/data").glob("*/robot.yaml")),
    "scene": sorted((ROOT / "src/ghc_sim_bridge/ghc_sim_bridge/scene/data").glob("*.yaml")),
    "scenario": sorted((ROOT / "src/ghc_sim_bridge/ghc_sim_bridge/scenario/data").glob("*.yaml")),
}
LOADERS: dict[str, Any] = {"robot": load_robot, "scene": load_scene, "scenario": load_scenario}
SHIPPED = [(kind, file) for kind, files in FILES.items() for file in files]


def schema_of(kind: str) -> dict[str, Any]:
    text = (FOLDER / f"{kind}.schema.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text, parse_constant=_no_constant)
    return schema


def _no_constant(name: str) -> None:
    raise AssertionError(f"{name} is no JSON")


def found(kind: str, values: Any) -> list[str]:
    schema = schema_of(kind)
    return problems(values, schema, schema)


def test_the_committed_schemas_are_fresh(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "ghc_sim_bridge.programs.schemas", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True)
    written = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()}
    kept = {path.name: path.read_text(encoding="utf-8") for path in FOLDER.iterdir()}
    assert written == kept, "run: python -m ghc_sim_bridge.programs.schemas"


@pytest.mark.parametrize(
    ("kind", "file"), SHIPPED, ids=lambda value: getattr(value, "stem", value)
)
def test_every_shipped_file_is_valid(kind: str, file: Path) -> None:
    assert found(kind, yaml.safe_load(file.read_text(encoding="utf-8"))) == []


def test_the_files_of_the_document_are_valid_and_name_their_schema() -> None:
    text = (ROOT / "docs" / "own_robot.md").read_text(encoding="utf-8")
    for kind in FILES:
        assert f"{kind}.schema.json" in text
    shown = [b.text for b in blocks(ROOT / "docs" / "own_robot.md", "yaml")]
    kinds = {"robot.yaml": "robot", "scene.yaml": "scene", "reach.yaml": "scenario"}
    seen = 0
    for block in shown:
        for name, kind in kinds.items():
            if block.startswith(f"# planar_arm/{name}"):
                assert found(kind, yaml.safe_load(block)) == []
                seen += 1
    assert seen == len(kinds)


def test_every_kind_of_task_and_every_text_is_in_the_schema() -> None:
    items = schema_of("robot")["properties"]["tasks"]["items"]
    assert set(items["properties"]["kind"]["enum"]) >= set(TASKS)
    for kind in FILES:
        schema = schema_of(kind)
        for record in (schema, *schema["definitions"].values()):
            for name, field in record["properties"].items():
                assert field["description"], name


MISTAKES: list[tuple[str, str, dict[str, Any], str]] = [
    ("robot", "kuka_lwr", {"floating_base": "no"}, ".floating_base: boolean expected"),
    ("robot", "kuka_lwr", {"colour": "red"}, ".colour: unknown"),
    ("robot", "kuka_lwr", {"limits": {"torque_rate": 0}}, ".limits.torque_rate: out of range"),
    ("robot", "kuka_lwr", {"limits": {"velocity": -1}}, ".limits.velocity: out of range"),
    ("robot", "kuka_lwr", {"limits": {"torque": {"joint_1": 0}}}, ".torque.joint_1: out of range"),
    ("robot", "kuka_lwr", {"settings": {"metric": "x"}}, ".settings.metric: another value"),
    ("robot", "kuka_lwr", {"tasks": []}, ".tasks: too short"),
    (
        "robot",
        "kuka_lwr",
        {"tasks": [{"kind": "posture", "name": "p", "stiffness": 1, "damping": 1, "frame": "x"}]},
        ".tasks[0].frame: unknown",
    ),
    ("scene", "kuka_lwr", {"gravity": [0, 0]}, ".gravity: too short"),
    ("scene", "kuka_lwr", {"start": {"joint_1": "high"}}, ".start.joint_1: number expected"),
    (
        "scenario",
        "priority_switching",
        {"parameters": {"controller": {"velocity_dampin": 1.0}}},
        ".parameters.controller.velocity_dampin: unknown",
    ),
    ("scenario", "priority_switching", {"transition": -1}, ".transition: out of range"),
    ("scenario", "nonstrict", {"titel": "t"}, ".titel: unknown"),
]


@pytest.mark.parametrize(("kind", "name", "change", "problem"), MISTAKES)
def test_editors_and_readers_refuse_the_same_mistakes(
    tmp_path: Path, kind: str, name: str, change: dict[str, Any], problem: str
) -> None:
    (file,) = (f for f in FILES[kind] if name in (f.stem, f.parent.name))
    values = copy.deepcopy(yaml.safe_load(file.read_text(encoding="utf-8"))) | change
    if kind == "robot":
        values["urdf"] = str(file.parent / values["urdf"])
    assert any(problem in text for text in found(kind, values))
    with pytest.raises(GhcError):
        load(kind, values, tmp_path)


def load(kind: str, values: Any, folder: Path) -> None:
    """Read a file that holds the values."""
    file = folder / ("robot.yaml" if kind == "robot" else "mine.yaml")
    file.write_text(yaml.safe_dump(values), encoding="utf-8")
    loaded = LOADERS[kind](str(file))
    if kind == "robot":
        Settings.for_robot(loaded)


REPLACEMENTS = [None, -1.0, 0, "x", "", True, math.inf, [], [1.0], {}, {"a": 1.0}]


@pytest.mark.parametrize("kind", ["robot", "scene"])
def test_editors_refuse_nothing_that_readers_take(kind: str, tmp_path: Path) -> None:
    """One value of a shipped file of the LWR replaced, at 150 places drawn with seed 11."""
    (file,) = (f for f in FILES[kind] if "kuka_lwr" in (f.stem, f.parent.name))
    values = yaml.safe_load(file.read_text(encoding="utf-8"))
    if kind == "robot":
        values["urdf"] = str(file.parent / values["urdf"])
    changes = [(at, new) for at in places(values) for new in REPLACEMENTS]
    refused = 0
    for k in np.random.default_rng(11).permutation(len(changes))[:150]:
        at, new = changes[k]
        changed = with_value(values, at, new)
        if found(kind, changed):
            refused += 1
            with pytest.raises(GhcError):
                load(kind, changed, tmp_path)
    assert refused > 80


def places(value: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Keys and indices that lead to each value of a file."""
    if at:
        yield at
    items = enumerate(value) if isinstance(value, list) else ()
    for key, item in value.items() if isinstance(value, dict) else items:
        yield from places(item, (*at, key))


def with_value(values: Any, at: tuple[Any, ...], new: Any) -> Any:
    """A copy with another value at one place."""
    changed = copy.deepcopy(values)
    around = changed
    for key in at[:-1]:
        around = around[key]
    around[at[-1]] = new
    return changed
