"""The arm of docs/own_robot.md as files of a folder, with one thing changed."""

from __future__ import annotations

import logging
import re
from pathlib import Path

import ghc_controller as ghc
from benchmarks.mistakes.mistake import Doing, refused
from ghc_sim_bridge import Simulator, load_scene
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

_PAGE = Path(__file__).resolve().parents[2] / "docs" / "own_robot.md"
_FILE = re.compile(r"^```\w+\n(?:<!--|#) planar_arm/(\S+?)(?: -->)?\n(.*?)^```$", re.M | re.S)
ROBOT, URDF, SCENE, SCENARIO = "robot.yaml", "planar_arm.urdf", "scene.yaml", "reach.yaml"


def write_arm(folder: Path) -> None:
    """Write the four files of the page into a folder."""
    for name, text in _FILE.findall(_PAGE.read_text(encoding="utf-8")):
        here = text.replace("planar_arm/robot.yaml", "./robot.yaml")
        here = here.replace("planar_arm/scene.yaml", "./scene.yaml")
        (folder / name).write_text(here, encoding="utf-8")


def edited(file: str, old: str, new: str) -> Doing:
    """The arm with `old` replaced in one of its files; read by controller, bridge, experiment."""

    def do(folder: Path) -> str:
        write_arm(folder)
        path = folder / file
        text = path.read_text(encoding="utf-8")
        if old not in text:
            raise ValueError(f"{file}: '{old}' is not in the arm of {_PAGE.name}")
        path.write_text(text.replace(old, new, 1), encoding="utf-8")
        return started(folder)

    return do


def started(folder: Path) -> str:
    """What the programs print that read the files in `folder`: the first error, or the warnings.

    The experiment makes its plan, the controller its robot, the bridge its simulator: as their
    processes do before anything runs.
    """
    with _Warnings() as warnings:
        error = refused(lambda: _start(folder))
    return "; ".join([*warnings.lines, *([error] if error else [])])


def _start(folder: Path) -> None:
    scenario = load_scenario(str(folder / SCENARIO))
    make_plan(scenario, RunOptions(), folder / "results")
    ghc.Controller.for_robot(folder / ROBOT)
    Simulator(load_scene(folder / SCENE))


class _Warnings(logging.Handler):
    """Lines that are logged as warnings meanwhile."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a line once."""
        line = record.getMessage()
        if line not in self.lines:
            self.lines.append(line)

    def __enter__(self) -> _Warnings:
        logging.getLogger("ghc_controller").addHandler(self)
        return self

    def __exit__(self, *_: object) -> None:
        logging.getLogger("ghc_controller").removeHandler(self)
