"""Conflicting, constantly changing tasks of an arm or of the arms of a standing humanoid."""

from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

import numpy as np

import ghc_controller as ghc
from benchmarks.models import STUDY_ROBOTS
from benchmarks.random_tasks import random_matrix, strict_matrix
from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array
from ghc_sim_bridge import SimulationDiverged, Simulator

_PERIOD = 300  # [ms] between new priorities
_DURATIONS = (0.0, 0.005, 0.05, 0.1, 0.3)  # [s] of the transitions
_FALLEN = 0.6  # [-] height of the base, of that at the start, below which a robot has fallen
_KEPT = ("hip", "knee", "ankle", "torso", "neck")  # joints whose posture stays that of the start


class Loop(NamedTuple):
    """A robot of `study_robots` in its scene, and how its targets change."""

    robot: str
    scene: str
    targets_every: int  # [ms]
    torque_rate: float = -1.0  # [Nm/s]; negative = of the robot
    standing: int = 0  # leading tasks that keep their targets and stand above all others
    center: str = ""  # frame about whose start position targets lie; "" = (0, 0, 0.3) m
    reach: tuple[float, float] = (0.2, 1.1)  # [m] distances of position targets from the center


def run_loop(loop: Loop, formulation: str, seed: int, duration: float) -> dict[str, Any]:
    """Run `duration` [s] of closed loop and measure how limits held."""
    settings = ghc.Settings(formulation=formulation, torque_rate_limit=loop.torque_rate)
    controller = ghc.Controller.for_robot(STUDY_ROBOTS / f"{loop.robot}.yaml", settings)
    model = controller.model
    simulator = Simulator(loop.scene, joint_names=model.joint_names)
    start = simulator.state()
    controller.observe(start)
    center = np.array([0.0, 0.0, 0.3])
    if loop.center:
        center = model.frame(model.frame_id(loop.center)).position.copy()
    rng = np.random.default_rng(seed)
    status: Counter[str] = Counter({s.name: 0 for s in ghc.StepStatus})
    beyond, too_fast, too_strong, refused, rate_gave_way = -np.inf, -np.inf, -np.inf, 0, 0
    steps: list[float] = []
    previous: Array | None = None
    ended: float | None = None
    for tick in range(round(1e3 * duration)):
        state = simulator.state()
        if tick % _PERIOD == 0:
            refused += not _change_priorities(controller, loop, state.time, rng)
        if tick % loop.targets_every == 0:
            controller.observe(state)
            for task, target in _targets(controller, loop, start.q, center, rng):
                controller.set_reference(task, target, state.time)
        result = controller.step(state)
        status[result.status.name] += 1
        rate_gave_way += result.solution.rate_gave_way
        torque = result.torque.copy()
        too_strong = max(too_strong, float(np.max(np.abs(torque) - model.torque_limit)))
        if previous is not None:
            steps.append(float(np.abs(torque - previous).max()))
        previous = torque
        try:
            simulator.step(torque)
        except SimulationDiverged:
            ended = state.time
            break
        after = simulator.state()
        q, v = after.q[-model.na :], after.v[-model.na :]
        outside = np.maximum(q - model.position_upper, model.position_lower - q)
        beyond = max(beyond, float(outside.max()))
        too_fast = max(too_fast, float(np.max(np.abs(v) / model.velocity_limit - 1.0)))
        if model.floating_base and after.q[2] < _FALLEN * start.q[2]:
            ended = after.time
            break
    return {
        "status": dict(status),
        "position_excess_rad": max(0.0, beyond),
        "velocity_excess_percent": max(0.0, 100.0 * too_fast),
        "torque_excess_nm": max(0.0, too_strong),
        "largest_torque_step_nm": max(steps),
        "rate_gave_way": rate_gave_way,
        "refused_transitions": refused,
        "ended_at_s": ended,
    }


def _change_priorities(
    controller: ghc.Controller, loop: Loop, now: float, rng: np.random.Generator
) -> bool:
    names, kept = controller.robot.task_names, loop.standing
    alpha = np.zeros((len(names), len(names)))
    alpha[kept:, kept:] = _random_priorities(loop, rng, len(names) - kept)
    alpha[kept:, :kept] = 1.0
    transition = ghc.Transition(
        ghc.PriorityMatrix(names, alpha), now, float(rng.choice(_DURATIONS))
    )
    try:
        controller.add_transition(transition, now)
    except InvalidValue:  # eq. 13b would lose its solution
        return False
    return True


def _random_priorities(loop: Loop, rng: np.random.Generator, count: int) -> Array:
    """Strict orders only for a standing robot: other matrices would weight its balance."""
    if not loop.standing:
        return random_matrix(rng, count)[0]
    some = rng.permutation(count)[: int(rng.integers(1, count + 1))]
    return strict_matrix([int(task) for task in some], count)


def _targets(
    controller: ghc.Controller, loop: Loop, start: Array, center: Array, rng: np.random.Generator
) -> list[tuple[str, Array]]:
    """Targets of all tasks but the standing ones; legs, torso and neck keep theirs."""
    model, found = controller.model, []
    kept = [any(part in name for part in _KEPT) for name in model.joint_names]
    for task in controller.robot.tasks[loop.standing :]:
        if task.name == "posture":
            target = rng.uniform(model.position_lower * 1.05, model.position_upper * 1.05)
            target = np.where(kept, start[-model.na :], target)
        elif task.name == "tool_orientation":
            target = rng.normal(size=4)
            target /= np.linalg.norm(target)
        else:
            target = rng.normal(size=3)
            target = target / np.linalg.norm(target) * rng.uniform(*loop.reach) + center
        found.append((task.name, target))
    return found
