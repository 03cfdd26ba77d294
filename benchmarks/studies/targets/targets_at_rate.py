"""KUKA, reachable targets with stiff gains: what the torque rate limit costs in accuracy."""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.models import STUDY_ROBOTS
from benchmarks.study_results import shown
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "targets_at_rate"
TITLE = "KUKA, reachable targets with and without the torque rate limit"
FORMULATIONS = ("cascade",)
_ROBOT = STUDY_ROBOTS / "kuka_stiff.yaml"
_RATES = {"off": 0.0, "on": -1.0}  # [Nm/s]; negative = of the robot
_HOLD = 2000  # [ms] of each target
_INSIDE = 0.9  # [-] of the joint range, from which postures are drawn
_CLOSE = 0.01  # [m]
_GOAL = 1.25  # [-] mean error with the limit over that without, at most


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """The same targets with both rates; every task has that of one random posture."""
    targets, seeds = (1, (0,)) if quick else (10, (0, 1))
    hold = 20 if quick else _HOLD
    found = {
        name: {
            title: {str(seed): _loop(name, rate, seed, targets, hold) for seed in seeds}
            for title, rate in _RATES.items()
        }
        for name in formulations
    }
    facts = {"targets": targets, "hold_ms": hold, "seeds": list(seeds)}
    return {"facts": facts, "formulations": found}


def _loop(formulation: str, rate: float, seed: int, targets: int, hold: int) -> dict[str, Any]:
    settings = ghc.Settings(formulation=formulation, torque_rate_limit=rate)
    controller, posed = (
        ghc.Controller.for_robot(_ROBOT, settings),
        ghc.Controller.for_robot(_ROBOT),
    )
    model, rng = controller.model, np.random.default_rng(seed)
    simulator = Simulator("kuka_lwr", joint_names=model.joint_names)
    error: Array = np.empty((targets, hold))
    fastest = 0.0
    for target in range(targets):
        controller.observe(simulator.state())
        q = rng.uniform(_INSIDE * model.position_lower, _INSIDE * model.position_upper)
        posed.model.update(q, np.zeros(model.nv))
        for task in posed.robot.tasks:
            controller.set_reference(task.name, np.array(task.current(posed.model)))
        for tick in range(hold):
            state = simulator.state()
            simulator.step(controller.step(state).torque)
            error[target, tick] = np.linalg.norm(controller.stack.error_of(0))
            fastest = max(fastest, float(np.max(np.abs(state.v) / model.velocity_limit)))
    far = [np.flatnonzero(row > _CLOSE) for row in error]
    settling = [int(late[-1]) + 1 if late.size else 0 for late in far]
    return {
        "mean_error_m": float(error.mean()),
        "final_error_m": float(np.median(error[:, -1])),
        "settling_ms": float(np.median(settling)),
        "fastest": fastest,
    }


def table(result: dict[str, Any]) -> str:
    """One line per formulation, rate limit and seed."""
    lines = []
    for name, rates in result["formulations"].items():
        for title, seeds in rates.items():
            for seed, row in seeds.items():
                ratio = row["mean_error_m"] / rates["off"][seed]["mean_error_m"]
                lines.append(
                    [
                        *(name, title, seed),
                        shown(row["mean_error_m"], ".4f"),
                        f"{ratio:.3f}",
                        shown(row["final_error_m"], ".1e"),
                        f"{row['settling_ms']:g}",
                        f"{row['fastest']:.3f}",
                    ]
                )
    head = ["formulation", "rate limit", "seed", "mean error [m]", "over that without"]
    head += ["final error, median [m]", f"settling to {_CLOSE:g} m, median [ms]"]
    head += ["largest speed / limit"]
    facts = result["facts"]
    return (
        f"{facts['targets']} random postures within {_INSIDE:g} of the joint range, each the "
        f"target of all five tasks for {1e-3 * facts['hold_ms']:g} s; gains 400 1/s^2, 40 1/s, "
        "order of the robot. Errors are those of the end effector, the first task. With the rate "
        "limit on, position and velocity limits plan with the jerk that it allows. Goal: ratio at "
        f"most {_GOAL:g}.\n\n" + markdown_table(head, lines)
    )
