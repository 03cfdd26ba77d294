"""Benchmarks stand in small rooms and use public names, but for what is listed here."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "benchmarks"
MODULES = sorted(FOLDER.rglob("*.py"))
MOST_MODULES = 16
PACKAGES = ("ghc_controller", "ghc_mpc_constraints", "ghc_sim_bridge")

# Deep modules and folders that benchmarks may import, and why no public name will do.
ALLOWED = {
    "ghc_controller.constraints": "the boxes are made and timed on their own",
    "ghc_controller.core": "fuzzed",
    "ghc_controller.errors": "which error a law raises is a result",
    "ghc_controller.formulations": "solved on their own; options; closed forms of the baselines",
    "ghc_controller.hierarchy": "levels, mixtures and projectors are what is studied",
    "ghc_controller.kinematics": "the velocity level, a library of its own without a face",
    "ghc_controller.model.robot_model": "robots without a robot.yaml: planar chains",
    "ghc_controller.model.rounded_shape": "shapes whose distances another library judges",
    "ghc_controller.numerics": "rotations of targets",
    "ghc_controller.previews": "plans without a generator, as inputs of a timed step",
    "ghc_controller.problem.reduction": "the part of a step that is timed",
    "ghc_controller.qp": "solvers are compared",
    "ghc_controller.reachable": "references that can be followed, without a face",
    "ghc_controller.references.plausibility": "fuzzed",
    "ghc_controller.report.valid_json": "reports in JSON are written as everywhere",
    "ghc_controller.robot.first_files": "files of new_robot, as its command writes them",
    "ghc_controller.robot.library": "the path of a robot.yaml that is to be changed",
    "ghc_controller.robot.robot": "fuzzed",
    "ghc_controller.ros": "nodes that drive nodes",
    "ghc_controller.safety": "fuzzed",
    "ghc_controller.tasks": "tasks of a robot without a robot.yaml",
    "ghc_controller.types": "arrays and bounds of problems made here",
    "ghc_mpc_constraints.obstacle_motion.approach": "the reaction time is swept",
    "ghc_mpc_constraints.ros.conversions": "nodes that drive nodes",
    "ghc_mpc_constraints.schedules.raw_bounds": "fuzzed",
    "ghc_sim_bridge.analysis.metrics": "the figures of a run, counted as everywhere",
    "ghc_sim_bridge.errors": "errors of the simulator",
    "ghc_sim_bridge.figures.style": "figures look alike",
    "ghc_sim_bridge.logs.full_rate_log": "the log of a run is read",
    "ghc_sim_bridge.programs.check_robot": "what it says of a mistake is a result",
    "ghc_sim_bridge.programs.markdown": "pages look alike",
    "ghc_sim_bridge.recorder": "fuzzed",
    "ghc_sim_bridge.ros.experiment_nodes": "nodes are started as an experiment does",
    "ghc_sim_bridge.ros.viewer_node": "its frame rate is measured",
    "ghc_sim_bridge.run": "nodes are started as an experiment does",
    "ghc_sim_bridge.scenario": "scenarios are run without nodes",
    "ghc_sim_bridge.scene.description": "the path of a scene that is to be changed",
    "ghc_sim_bridge.viewer": "the page of the viewer, with a patch that tells its frame",
}


def _deep_imports(path: Path) -> Iterator[tuple[str, str]]:
    """(module, name) of every import from below the root of a package."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), str(path))):
        if isinstance(node, ast.ImportFrom) and node.module:
            package, _, rest = node.module.partition(".")
            if package in PACKAGES and rest:
                yield from ((node.module, alias.name) for alias in node.names)


def _allowance(module: str) -> str | None:
    while module:
        if module in ALLOWED:
            return module
        module = module.rpartition(".")[0]
    return None


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_deep_imports_are_on_the_list(path: Path) -> None:
    assert [name for name in _deep_imports(path) if _allowance(name[0]) is None] == []


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_what_has_a_public_name_is_imported_by_it(path: Path) -> None:
    deep = [(module, name) for module, name in _deep_imports(path) if name in _public(module)]
    assert deep == []


def _public(module: str) -> list[str]:
    """Public names of the package that a module is in, if they stand for what is in it."""
    face = import_module(module.partition(".")[0])
    home = import_module(module)
    return [n for n in face.__all__ if getattr(home, n, None) is getattr(face, n)]


def test_rooms_are_small() -> None:
    counts: dict[Path, int] = {}
    for path in MODULES:
        counts[path.parent] = counts.get(path.parent, 0) + 1
    assert {str(f): n for f, n in counts.items() if n > MOST_MODULES} == {}
