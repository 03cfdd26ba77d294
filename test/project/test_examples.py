"""The examples run on public names alone and print what they promise."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import ghc_controller as ghc

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
ARGUMENTS = {"compare_formulations": ["0.1"]}
# What an example may import names from; of the packages these are their public names.
MODULES = ("__future__", "typing", "ghc_mpc_constraints", "ghc_sim_bridge")
PRINTS = {
    "arm_force_control": ["t = 0.5 s:  0.00 N", "t = 5.0 s: 20.00 N at z = 0.2999 m"],
    "arm_own_task": ["error of the distance: 0.0"],
    "arm_swap_priorities": ["t = 8 s: {'end_effector': 0.31", "Nm/s at a period of 1 ms"],
    "compare_formulations": [f"{name} " for name in ghc.FORMULATIONS],
    "force_bounds_preview": ["t = 1.0 s: raw 20 N, in force 20.0 N", "never looser than raw"],
    "humanoid_lift_foot": ["t = 2 s: foot at 0.010 m", "t = 6 s: foot at 0.060 m,   0.0 N"],
    "obstacle_preview": [
        "t = 1.5 s: wall at 0.60 m, for the controller at 0.61",
        "hand at 0.500 m",
    ],
    "own_generator": [
        "t = 1.5 s: limit 0.950 rad, joint 0.94",
        "limit 0.800 rad, joint 0.800 rad",
    ],
    "own_robot_in_python": ["mine: 7 joints", "SOLVED"],
}


@pytest.mark.parametrize("path", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_examples_run(path: Path) -> None:
    command = [sys.executable, str(path), *ARGUMENTS.get(path.stem, [])]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    for words in PRINTS[path.stem]:
        assert words in run.stdout


@pytest.mark.parametrize("path", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_examples_are_short_and_use_public_names(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert 30 <= len(text.splitlines()) <= 60
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            assert node.module in MODULES
        if isinstance(node, ast.Attribute) and getattr(node.value, "id", "") == "ghc":
            assert node.attr in ghc.__all__
