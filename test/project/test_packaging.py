"""`pip install ./src/ghc_controller`: what it brings is enough for the library without ROS."""

from __future__ import annotations

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import ghc_controller as ghc

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "ghc_controller"
START = [0.0, 0.5, 0.0, -1.2, 0.0, 0.8, 0.0]  # [rad]
TICKS = 12

# README's library example, without the simulator: the arm stands still.
_EXAMPLE = f"""
import json, sys
sys.modules["rclpy"] = None  # importing it fails
sys.path[:0] = sys.argv[1:]
import numpy as np
import ghc_controller as ghc
controller = ghc.Controller(ghc.load_robot("kuka_lwr"))
q, v = np.array({START}), np.zeros(7)
controller.start(ghc.RobotState(0.0, q, v))
controller.set_reference("end_effector", [0.61, 0.07, 0.82])
controller.set_reference("elbow", [0.0443, -0.3576, 0.4841])
controller.change_hierarchy("elbow > end_effector > posture", start=0.004, duration=0.004)
results = [controller.step(ghc.RobotState(1e-3 * tick, q, v)) for tick in range({TICKS})]
print(json.dumps({{
    "file": ghc.__file__,
    "torques": [result.torque.tolist() for result in results],
    "status": [result.status.name for result in results],
}}))
"""


_DISTRIBUTIONS = {"pinocchio": "pin", "yaml": "pyyaml"}  # where the name is not the module's


def _imported(path: Path) -> set[str]:
    """Top-level modules that a file imports."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(str(node.module).partition(".")[0])
    return found


def test_the_metadata_asks_for_all_that_the_library_imports() -> None:
    """Not for what ros/ imports, which comes with ROS, nor for what nothing imports."""
    library = PACKAGE / "ghc_controller"
    modules = [
        path for path in library.rglob("*.py") if "ros" not in path.parts[len(library.parts) :]
    ]
    imported = set().union(*map(_imported, modules)) - {*sys.stdlib_module_names, library.name}
    asked = re.search(
        r"install_requires=(\[.*?\])", (PACKAGE / "setup.py").read_text("utf-8"), re.S
    )
    assert asked is not None
    needed = {_DISTRIBUTIONS.get(name, name) for name in imported}
    assert needed == set(ast.literal_eval(asked[1]))


def _copy(folder: Path) -> Path:
    """The package as a clone holds it: nothing that was built."""
    ignored = shutil.ignore_patterns("build", "*.so", "*.egg-info", "__pycache__")
    return shutil.copytree(PACKAGE, folder / "ghc_controller", ignore=ignored)


def _check(run: subprocess.CompletedProcess[str], installed: Path) -> None:
    """The answers of the installed package are those of the sources."""
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout)
    assert Path(found["file"]).is_relative_to(installed)
    assert set(found["status"]) == {"SOLVED"}
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"))
    q, v = np.array(START), np.zeros(7)
    controller.start(ghc.RobotState(0.0, q, v))
    controller.set_reference("end_effector", [0.61, 0.07, 0.82])
    controller.set_reference("elbow", [0.0443, -0.3576, 0.4841])
    controller.change_hierarchy("elbow > end_effector > posture", start=0.004, duration=0.004)
    for tick, torque in enumerate(found["torques"]):
        wanted = controller.step(ghc.RobotState(1e-3 * tick, q, v)).torque
        assert np.abs(wanted - torque).max() < 1e-9


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_a_wheel_is_built_and_answers_without_the_sources(tmp_path: Path) -> None:
    """Without an index: the packages are those of this environment. No file of src/ is used."""
    target = tmp_path / "installed"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps"]
    pip += ["--no-index", "--target", str(target), str(_copy(tmp_path / "copy"))]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["GHC_CMAKE_ARGS"] = "-DCMAKE_CXX_FLAGS_RELEASE=-O0"  # quickly, with assertions
    built = subprocess.run(pip, env=environment, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    run = subprocess.run(
        [sys.executable, "-c", _EXAMPLE, str(target)],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    _check(run, target)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_an_empty_environment_gets_all_that_the_library_needs(tmp_path: Path) -> None:
    """From the package index, in the versions of the lock."""
    python = tmp_path / "venv" / "bin" / "python"
    clean = {
        name: value
        for name, value in os.environ.items()
        if name not in {"PYTHONPATH", "VIRTUAL_ENV", "LD_LIBRARY_PATH"}
        and not name.startswith("_ROS_")
    }
    lock = ROOT / "requirements" / f"lock-noros-py3.{sys.version_info.minor}.txt"
    pins = [
        line.split()[0] for line in lock.read_text(encoding="utf-8").splitlines() if "==" in line
    ]
    constraints = tmp_path / "constraints.txt"
    constraints.write_text("\n".join(pins) + "\n", encoding="utf-8")
    for command in (
        [sys.executable, "-m", "venv", str(tmp_path / "venv")],
        [str(python), "-m", "pip", "install", "--quiet", "--constraint", str(constraints)]
        + [str(_copy(tmp_path / "copy"))],
    ):
        run = subprocess.run(command, env=clean, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr
    run = subprocess.run(
        [str(python), "-c", _EXAMPLE],
        cwd=tmp_path,
        env=clean,
        capture_output=True,
        text=True,
        check=False,
    )
    _check(run, tmp_path / "venv")
