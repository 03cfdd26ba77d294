"""Who may import what: the libraries run without ROS, and one wrapper knows the solvers."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = sorted(path.parent.name for path in ROOT.glob("src/*/setup.py"))
SOLVERS = {"proxsuite", "daqp"}

# Modules at the rim, where ROS begins.
ROS_RIM = ("*_node.py", "*conversions.py", "*parameters.py", "*experiment*.py", "*recorder*.py")

# Programs on top of the experiment: they import no ROS themselves.
PROGRAMS = ("report.py", "paper*.py")

_IMPORT_ALL = """
import importlib, json, sys
for name in sys.argv[1:]:
    importlib.import_module(name)
    if "rclpy" in sys.modules:
        print(json.dumps(name))
        break
"""


def _modules() -> Iterator[tuple[str, Path]]:
    """Dotted name and file of every module of the Python packages."""
    for package in PACKAGES:
        folder = ROOT / "src" / package
        for path in sorted((folder / package).rglob("*.py")):
            parts = path.relative_to(folder).with_suffix("").parts
            yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts), path


def _imported(path: Path) -> set[str]:
    """Top-level names of what a file imports, wherever in the file the import stands."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), str(path))):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names.add(node.module.partition(".")[0])
    return names


def _matches(path: Path, patterns: tuple[str, ...]) -> bool:
    return any(fnmatch(path.name, pattern) for pattern in patterns)


MODULES = dict(_modules())


def test_only_the_rim_imports_ros() -> None:
    users = {name: path for name, path in MODULES.items() if "rclpy" in _imported(path)}
    assert users
    assert [name for name, path in users.items() if not _matches(path, ROS_RIM)] == []


def test_only_the_solver_wrapper_imports_solvers() -> None:
    wrong = [
        name
        for name, path in MODULES.items()
        if _imported(path) & SOLVERS and path.parent.name != "qp"
    ]
    assert wrong == []


def test_the_controller_does_not_know_the_simulator() -> None:
    forbidden = {"mujoco", "ghc_sim_bridge"}
    wrong = {
        name: sorted(_imported(path) & forbidden)
        for name, path in MODULES.items()
        if name.startswith("ghc_controller") and _imported(path) & forbidden
    }
    assert wrong == {}


def test_pure_modules_run_without_ros() -> None:
    """Importing them all brings no rclpy into the process, directly or by way of another."""
    pure = [name for name, path in MODULES.items() if not _matches(path, ROS_RIM + PROGRAMS)]
    assert len(pure) > len(MODULES) / 2
    run = subprocess.run(
        [sys.executable, "-c", _IMPORT_ALL, *pure], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    culprit = json.loads(run.stdout or "null")
    assert culprit is None, f"importing {culprit} imports rclpy"


@pytest.mark.parametrize("word", ["ROS_WHEELS", "site-packages", ".venv"])
def test_sources_know_nothing_of_wheels(word: str) -> None:
    assert [
        name for name, path in MODULES.items() if word in path.read_text(encoding="utf-8")
    ] == []


def test_no_robot_in_code() -> None:
    """A robot is data: its name stands in its own folder and in scenarios, not in a module."""
    folder = ROOT / "src" / "ghc_controller" / "ghc_controller" / "robot" / "data"
    robots = [path.parent.name for path in folder.glob("*/robot.yaml")]
    assert robots
    for robot in robots:
        named = [n for n, path in MODULES.items() if robot in path.read_text(encoding="utf-8")]
        assert named == [], robot
