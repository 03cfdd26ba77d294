"""The robots of the comparison, with as many tasks as asked for."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

import ghc_controller as ghc
from benchmarks.steps.robots import Arm, BenchRobot, Humanoid
from benchmarks.steps.standing_bench import TASKS
from tools.workspace.layout import Layout

STANDING = "icub_standing"
_ROOT = Path(__file__).resolve().parents[2]


@cache
def _humanoid() -> Humanoid:
    return Humanoid(Layout(_ROOT))


@cache
def bench_robot(name: str) -> BenchRobot:
    """The robot of `make bench`."""
    return Arm() if name == Arm.name else _humanoid()


def peer_robot(name: str, count: int) -> ghc.Robot:
    """A robot with its first `count - 1` tasks above the posture, in strict order."""
    if name != STANDING:
        return bench_robot(name).config(count)
    names = (*TASKS[: count - 1], TASKS[-1])
    robot = ghc.load_robot("icub")
    tasks = {task.name: task for task in robot.tasks}
    chosen = tuple(tasks[task] for task in names)
    return replace(robot, tasks=chosen, hierarchy=" > ".join(names))


def frames_of(name: str) -> dict[str, str]:
    """Frame of each task that has one."""
    if name != STANDING:
        return {f"{link}_{kind}": link for link, kind in bench_robot(name).frames}
    return {
        "root_orientation": "root_link",
        "left_hand": "l_hand_dh_frame",
        "right_hand": "r_hand_dh_frame",
    }


def urdf_file(name: str) -> str:
    """A URDF for the other sides: without shapes, whose meshes they would look for."""
    if name == Arm.name:
        return str(bench_robot(name).product().urdf)
    file = Path(tempfile.gettempdir()) / f"peers_{name}.urdf"
    file.write_text(_humanoid().urdf_text, encoding="utf-8")
    return str(file)
