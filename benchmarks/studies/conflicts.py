"""Panda, UR5 and KUKA with default settings: do arms come to rest where two targets conflict?"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.models import STUDY_ROBOTS, install_study_model
from benchmarks.problems.conflicting_targets import APART, Pair, conflicting_pairs
from benchmarks.study_results import shown, shown_spread, spread
from ghc_sim_bridge import SimulationDiverged, Simulator
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "conflicts"
TITLE = "Two conflicting targets: do arms come to rest?"
FORMULATIONS = ("cascade", "balanced")
_SEED = 0
_PAIRS = 20
_WINDOW = (10.0, 14.0)  # [s]
_PACKAGE = "example-robot-data"
_ARMS: dict[str, tuple[str | Path, str | Path]] = {  # robot, scene
    "panda": (STUDY_ROBOTS / "panda.yaml", STUDY_ROBOTS / "panda_scene.yaml"),
    "ur5": (STUDY_ROBOTS / "ur5.yaml", STUDY_ROBOTS / "ur5_scene.yaml"),
    "kuka_lwr": ("kuka_lwr", "kuka_lwr"),
}


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Static targets from a start at the posture reference."""
    arms = ["kuka_lwr"] if quick else list(_ARMS)
    count, window = (1, (0.1, 0.3)) if quick else (_PAIRS, _WINDOW)
    if not quick:
        install_study_model(_PACKAGE)
    found: dict[str, dict[str, Any]] = {name: {} for name in formulations}
    apart = {}
    for arm in arms:
        robot = ghc.load_robot(_ARMS[arm][0])
        pairs = conflicting_pairs(robot, count, _SEED)
        apart[arm] = spread([pair.apart for pair in pairs])
        for name in formulations:
            found[name][arm] = _of_arm(arm, name, pairs, window)
    facts = {"pairs": count, "seed": _SEED, "window_s": list(window), "apart_m": apart}
    return {"facts": facts, "formulations": found}


def _of_arm(
    arm: str, formulation: str, pairs: list[Pair], window: tuple[float, float]
) -> dict[str, Any]:
    robot, scene = _ARMS[arm]
    controller = ghc.Controller.for_robot(robot, ghc.Settings(formulation=formulation))
    simulator = Simulator(scene, joint_names=controller.model.joint_names)
    steps, speeds, unsolved, diverged = [], [], 0, 0
    for pair in pairs:
        try:
            step, speed, failed = _rest(controller, simulator, pair, window)
        except SimulationDiverged:
            diverged += 1
            continue
        steps.append(step)
        speeds.append(speed)
        unsolved += failed
    return {
        "torque_step_nm": spread(steps),
        "joint_speed": spread(speeds),
        "unsolved_ticks": unsolved,
        "diverged": diverged,
    }


def _rest(
    controller: ghc.Controller, simulator: Simulator, pair: Pair, window: tuple[float, float]
) -> tuple[float, float, int]:
    """Largest torque step [Nm per ms], joint speed [rad/s] and unsolved ticks in the window."""
    simulator.reset()
    controller.reset()
    state = simulator.state()
    controller.observe(state)
    for task, target in zip(controller.robot.tasks, (pair.upper, pair.lower), strict=False):
        controller.add_reference(ghc.ReferenceTrajectory.static(task, task.static_target(target)))
    previous = np.zeros(controller.model.na)
    step = speed = 0.0
    unsolved = 0
    while state.time < window[1]:
        result = controller.step(state)
        if state.time >= window[0]:
            step = max(step, float(np.abs(result.torque - previous).max()))
            speed = max(speed, float(np.abs(state.v).max()))
            unsolved += result.status is not ghc.StepStatus.SOLVED
        previous = result.torque.copy()
        simulator.step(result.torque)
        state = simulator.state()
    return step, speed, unsolved


def table(result: dict[str, Any]) -> str:
    """Worst and typical pair of each arm."""
    facts, lines = result["facts"], []
    for name, arms in result["formulations"].items():
        for arm, row in arms.items():
            motion = [shown_spread(row[key]) for key in ("torque_step_nm", "joint_speed")]
            near = shown(facts["apart_m"][arm]["median"])
            counts = [str(row[key]) for key in ("unsolved_ticks", "diverged")]
            lines.append([name, arm, *motion, near, *counts])
    first, last = facts["window_s"]
    head = ["formulation", "arm", "largest torque step [Nm per ms]", "largest joint speed [rad/s]"]
    head += ["apart, median [m]", "ticks not SOLVED", "diverged"]
    return (
        f"{facts['pairs']} seeded pairs (seed {facts['seed']}) of static position targets for "
        f"last link and elbow per arm, each reachable alone, at least {APART:g} m (norm of both "
        "errors) from being met together. Order end_effector > elbow > posture, default settings "
        f"with the torque rate limit of 1000 Nm/s. From {first:g} to {last:g} s, "
        "median / p95 / max over the pairs; speeds of fingers are in m/s.\n\n"
        + markdown_table(head, lines)
    )
