"""Who may import what: ROS in one folder of a package, packages in a chain, no circles."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CHAIN = ("ghc_msgs", "ghc_controller", "ghc_mpc_constraints", "ghc_sim_bridge")
PACKAGES = CHAIN[1:]
SOLVERS = {"proxsuite", "daqp"}

ROS_PACKAGES = {"rclpy", "rosidl_runtime_py", "rosbag2_py", "launch", "launch_ros"}
ROS_SUFFIXES = ("_msgs", "_srvs", "_interfaces", "_index_python")  # messages, ament's index

MOST_MODULES = 16  # of a folder
MOST_MODULES_AT_ROOT = 8

# Programs that start nodes; what they import of ROS is in ros/.
RUNNING_PROGRAMS = ("ghc_sim_bridge.programs.report", "ghc_sim_bridge.programs.paper")

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


MODULES = dict(_modules())


def _imported(path: Path) -> set[str]:
    """Dotted names that a file imports, wherever in the file the import stands."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), str(path))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            module = node.module or ""
            names |= {module, *(f"{module}.{alias.name}" for alias in node.names)}
    return names


def _packages_imported(path: Path) -> set[str]:
    return {name.partition(".")[0] for name in _imported(path)}


def _and_parents(name: str) -> Iterator[str]:
    """The name and the packages that Python imports before it."""
    while name:
        yield name
        name = name.rpartition(".")[0]


def _graph() -> dict[str, set[str]]:
    """Module -> the modules that it needs; packages around itself are not counted."""
    return {
        module: {
            needed
            for name in _imported(path)
            for needed in _and_parents(name)
            if needed in MODULES and not f"{module}.".startswith(f"{needed}.")
        }
        for module, path in MODULES.items()
    }


def _room(module: str) -> str:
    """Folder at the root of a package that holds a module; a module at the root is its own."""
    return ".".join(module.split(".")[:2])


def _circle(graph: Mapping[str, set[str]]) -> list[str]:
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


GRAPH = _graph()


def _is_ros(package: str) -> bool:
    return package in ROS_PACKAGES or package.endswith(ROS_SUFFIXES)


def _is_in_ros(module: str) -> bool:
    return _room(module).endswith(".ros")


def test_only_the_rim_imports_ros() -> None:
    users = {name for name, path in MODULES.items() if any(map(_is_ros, _packages_imported(path)))}
    assert {name.partition(".")[0] for name in users} == set(PACKAGES)
    assert [name for name in sorted(users) if not _is_in_ros(name)] == []


def test_nothing_but_programs_stands_on_a_package_s_own_ros_folder() -> None:
    wrong = {
        name: needed
        for name, others in GRAPH.items()
        if not _is_in_ros(name)
        and not name.startswith("ghc_sim_bridge.programs.")
        and (
            needed := {other for other in others if other.startswith(f"{name.split('.')[0]}.ros")}
        )
    }
    assert wrong == {}


def test_packages_are_a_chain() -> None:
    wrong = {
        name: later
        for name, path in MODULES.items()
        if (
            later := _packages_imported(path)
            & set(CHAIN[CHAIN.index(name.partition(".")[0]) + 1 :])
        )
    }
    assert wrong == {}


def test_no_import_circle() -> None:
    assert len(GRAPH) > 200
    assert _circle(GRAPH) == []


def test_rooms_do_not_import_each_other() -> None:
    rooms: dict[str, set[str]] = {}
    for module, others in GRAPH.items():
        room = _room(module)
        rooms.setdefault(room, set()).update(
            _room(other) for other in others if _room(other) != room
        )
    assert _circle(rooms) == []


@pytest.mark.parametrize("package", PACKAGES)
def test_folders_are_small(package: str) -> None:
    root = ROOT / "src" / package / package
    counts: dict[Path, int] = {}
    for path in root.rglob("*.py"):
        counts[path.parent] = counts.get(path.parent, 0) + 1
    assert counts.pop(root) <= MOST_MODULES_AT_ROOT
    assert {folder: n for folder, n in counts.items() if n > MOST_MODULES} == {}


def test_only_the_solver_wrapper_imports_solvers() -> None:
    wrong = [
        name
        for name, path in MODULES.items()
        if _packages_imported(path) & SOLVERS and path.parent.name != "qp"
    ]
    assert wrong == []


def test_the_controller_does_not_know_the_simulator() -> None:
    forbidden = {"mujoco", "ghc_sim_bridge"}
    wrong = {
        name: sorted(_packages_imported(path) & forbidden)
        for name, path in MODULES.items()
        if name.startswith("ghc_controller") and _packages_imported(path) & forbidden
    }
    assert wrong == {}


def test_pure_modules_run_without_ros() -> None:
    """Importing them all brings no rclpy into the process, directly or by way of another."""
    pure = [
        name for name in MODULES if not _is_in_ros(name) and not name.startswith(RUNNING_PROGRAMS)
    ]
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
