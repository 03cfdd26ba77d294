"""A robot whose hands get random targets in a shared space, and the least distances on the way."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np

import ghc_controller as ghc
from benchmarks.bodies.judge import Judge
from benchmarks.models import STUDY_ROBOTS
from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator

_JUDGED = 5  # [ms] between two looks at all distances


class Loop(NamedTuple):
    """A robot, and where the targets of its hands are drawn."""

    robot: str | Path
    scene: str | Path
    hands: dict[str, tuple[tuple[float, float], ...]]  # task -> (3, 2) [m] range of each axis
    side: tuple[float, float, float]  # unit, from the second hand to the first in front of it
    apart: float  # [m] between the frames of the hands when they touch side by side
    every: int = 1500  # [ms] between new targets


_SHARED = ((0.3, 0.65), (-0.3, 0.3), (0.2, 0.75))
_IN_FRONT = ((-0.32, -0.12), (-0.15, 0.15), (-0.02, 0.25))
LOOPS = {
    "two_arms": Loop(
        "two_arms",
        "two_arms",
        {"left_hand": _SHARED, "right_hand": _SHARED},
        (0.0, 1.0, 0.0),
        0.11,
    ),
    "icub": Loop(
        STUDY_ROBOTS / "icub_bodies.yaml",
        STUDY_ROBOTS / "icub_bodies_scene.yaml",
        {"left_hand": _IN_FRONT, "right_hand": _IN_FRONT},
        (0.0, -1.0, 0.0),
        0.09,
    ),
}


def find_constraint(robot: ghc.Robot) -> BodyDistance:
    """The constraint of a robot on distances of bodies."""
    return next(one for one in robot.constraints if isinstance(one, BodyDistance))


def run_loop(
    loop: Loop, formulation: str, seed: int, duration: float, constrained: bool = True
) -> dict[str, Any]:
    """Run `duration` [s] of closed loop; without the constraint the same targets."""
    robot, judged = ghc.load_robot(loop.robot), ghc.load_robot(loop.robot)
    if not constrained:
        robot = replace(robot, constraints=())
    controller = ghc.Controller(robot, ghc.Settings(formulation=formulation))
    constraint, model = find_constraint(judged), controller.model
    simulator = Simulator(loop.scene, joint_names=model.joint_names)
    judge = Judge(constraint, judged.model)
    controller.start(simulator.state())
    rng = np.random.default_rng(seed)
    status: Counter[str] = Counter({s.name: 0 for s in ghc.StepStatus})
    least: Array = np.full(len(constraint.pairs), np.inf)
    margins, active, previous = constraint.pair_margins(0.0), 0, None
    steps, cpu = [], 0.0
    for tick in range(round(1e3 * duration)):
        state = simulator.state()
        if tick % loop.every == 0:
            for task, box in loop.hands.items():
                low, high = np.array(box).T
                controller.set_reference(task, rng.uniform(low, high), state.time)
        begin = process_time()
        result = controller.step(state)
        cpu += process_time() - begin
        status[result.status.name] += 1
        if tick % 10 == 0:
            names = controller.report().active_constraints
            active += any(name.startswith(f"{constraint.name}.") for name in names)
        if previous is not None:
            steps.append(float(np.abs(result.torque - previous).max()))
        previous = result.torque.copy()
        simulator.step(result.torque)
        if tick % _JUDGED == 0:
            least = np.minimum(least, judge.distances(simulator.state().q))
    below = margins - least
    worst = int(np.argmax(below))
    return {
        "below_margin_m": max(0.0, float(below[worst])),
        "worst_pair": "-".join(constraint.pairs[worst]),
        "pairs": len(constraint.pairs),
        "pairs_within_1_cm": int(np.count_nonzero(below > -0.01)),
        "active_share": active / (len(steps) / 10.0),
        "largest_torque_step_nm": max(steps),
        "status": dict(status),
        "step_cpu_ms": 1e3 * cpu / (len(steps) + 1),
    }
