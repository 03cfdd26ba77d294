"""`new_robot`, then a swap over DDS, for robots that nobody here has touched.

    python -m benchmarks.users.new_robots go2 g1 --seeds 0 1

Models are those of the package example-robot-data, and an MJCF arm. Nothing is edited by hand; the
targets of swap.yaml are drawn by seed among reachable ones.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

import ghc_controller as ghc
from benchmarks.models import ROOT, install_study_model
from ghc_controller.robot.first_files.legged import Stance
from ghc_controller.robot.first_files.new_robot import write_first_files
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.programs.markdown import table
from ghc_sim_bridge.run.executables import find_executable

_PACKAGE = "example-robot-data"
_TURN = 0.2  # [rad] or [m] by which joints move to the posture of a target, at most
_CENTER = np.array([0.02, 0.015, 0.01])  # [m] of the center of mass, for one at 0.5 m or more
_TILT = 0.06  # [rad] of a base, about x and y
_PATIENCE = 1200.0  # [s] wall, of one run


class Model(NamedTuple):
    """Files below `robots` of the package; an SRDF gives the start."""

    urdf: str
    srdf: str = ""


MODELS = {
    "panda": Model("panda_description/urdf/panda.urdf"),
    "ur5": Model("ur_description/urdf/ur5_robot.urdf"),
    "kinova": Model("kinova_description/robots/kinova.urdf"),
    "xarm7": Model("xarm_description/urdf/xarm7.urdf"),
    "z1": Model("z1_description/urdf/z1.urdf"),
    "go2": Model("go2_description/urdf/go2.urdf", "go2_description/srdf/go2.srdf"),
    "solo12": Model("solo_description/robots/solo12.urdf", "solo_description/srdf/solo.srdf"),
    "g1": Model("g1_description/urdf/g1_29dof_rev_1_0.urdf"),
    "talos": Model("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf"),
}


class Phase(NamedTuple):
    """End of a phase."""

    hierarchy: str
    first: float  # [m] or [rad] error of its first task
    speed: float  # [rad/s] mean |v| of all joints over the last second


def make_files(name: str, folder: Path, seed: int) -> Path:
    """First files of a robot in a new folder; swap.yaml with targets of this seed."""
    install_study_model(_PACKAGE)
    place = f"lib/python3*/site-packages/cmeel.prefix/share/{_PACKAGE}/robots"
    models = next(Path(sys.prefix).glob(place))
    model = MODELS[name]
    srdf = models / model.srdf if model.srdf else None
    chosen = write_first_files(models / model.urdf, folder, name, srdf)
    swap = folder / "swap.yaml"
    content = yaml.safe_load(swap.read_text(encoding="utf-8"))
    for task, position in _targets(folder, chosen, list(content["references"]), seed).items():
        content["references"][task] = {"position": [float(value) for value in position]}
    swap.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
    return swap


def _targets(folder: Path, chosen: Any, tasks: list[str], seed: int) -> dict[str, Array]:
    """Task -> reference: where its frame is in a posture near the start, a small balance shift."""
    rng, robot = np.random.default_rng(seed), ghc.load_robot(folder)
    model = robot.model
    state = Simulator(folder / "scene.yaml", joint_names=model.joint_names).state()
    model.update(state.q, state.v)
    center = model.center_of_mass().copy()
    free = np.ones(model.na)
    if isinstance(chosen, Stance):
        legs = [joint - (model.nv - model.na) for foot in chosen.feet for joint in foot.joints]
        free[legs] = 0.0
    q = state.q.copy()
    joints = q[-model.na :] + free * rng.uniform(-_TURN, _TURN, model.na)
    q[-model.na :] = np.clip(joints, model.position_lower, model.position_upper)
    model.update(q, state.v)
    found = {}
    for task in robot.tasks:
        if task.name not in tasks:
            continue
        if task.name == "center_of_mass":
            found[task.name] = center + min(1.0, center[2] / 0.5) * rng.uniform(-_CENTER, _CENTER)
        elif task.name == "base_orientation":
            tilt = 0.5 * rng.uniform(-_TILT, _TILT, 2)
            found[task.name] = np.array([*tilt, 0.0, np.sqrt(1.0 - tilt @ tilt)])
        else:
            found[task.name] = task.current(model).copy()
    return found


def run(name: str, folder: Path, seed: int) -> list[Phase]:
    """All phases of a swap over DDS, in its own processes.

    Raises:
        RuntimeError: the run failed; with its last lines.
    """
    swap = make_files(name, folder / name, seed)
    command = [str(find_executable("ghc_sim_bridge", "experiment")), "--scenario", str(swap)]
    command += ["--output", str(folder / "results")]
    done = subprocess.run(
        command, cwd=ROOT, env=os.environ, capture_output=True, text=True, timeout=_PATIENCE
    )
    if done.returncode:
        raise RuntimeError("\n".join((done.stdout + done.stderr).splitlines()[-20:]))
    file = next((folder / "results").rglob("summary.json"))
    summary = json.loads(file.read_text(encoding="utf-8"))
    log = FullRateLog.load(file.with_name("log.npz"))
    phases = []
    for one in summary["phases"]:
        last = (log.time > one["t_end"] - 1.0) & (log.time <= one["t_end"])
        error = one["errors"][one["hierarchy"].partition(" ")[0]]
        speed = float(np.abs(log.v[last][:, -len(log.joint_names) :]).mean())
        phases.append(Phase(one["hierarchy"], error, speed))
    return phases


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(MODELS))
    parser.add_argument("--seeds", nargs="+", type=int, default=[0])
    options = parser.parse_args()
    rows = []
    for name in options.names or MODELS:
        for seed in options.seeds:
            with tempfile.TemporaryDirectory() as folder:
                phases = run(name, Path(folder), seed)
            first = ", ".join(f"{phase.first:.1e}" for phase in phases)
            speed = ", ".join(f"{phase.speed:.1e}" for phase in phases)
            rows.append([name, str(seed), first, speed])
            print(" ".join(rows[-1]), flush=True)
    print(table(["robot", "seed", "first task [m, rad]", "mean speed [rad/s]"], rows))


if __name__ == "__main__":
    main()
