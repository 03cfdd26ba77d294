"""Targets of T1 to T19 and the figures of a run: Sigma, Xi, Psi."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.kinematics.planar_robot import SHOULDER_BOX, START, planar_levels, planar_robot
from ghc_controller.kinematics import KinematicSettings, TaskSolver
from ghc_controller.types import Array

STEPS = 25000
PERIOD = 5000  # [steps] of the oscillation; not in the paper
SEED = 0  # of T9
STATIC = range(4, 10)  # tests with Psi; T9 is static in its second half
_NEAR = 1e-3  # [m]
_OFFSETS = ((1, 2), (1 + _NEAR, 2 + _NEAR), (1 - _NEAR, 2 - _NEAR), (11, 12), (0.75, 1.75))  # x, y
_STILL = 1e-6  # [rad], [m] of Psi
TRACE = 100  # [steps] between stored points


@dataclass(frozen=True, slots=True)
class PlanarTest:
    """Targets of ef2 (level 1) and ef3 (level 2), (steps, 2) [m] each."""

    number: int
    first: Array
    second: Array

    @property
    def shoulder_box(self) -> bool:
        """Whether the shoulder has to stay in its box (hierarchy B)."""
        return self.number == 2


def planar_test(number: int, steps: int = STEPS) -> PlanarTest:
    """One of T1 to T19; shorter runs see the same targets up to their end (T9: scaled)."""
    k = np.arange(steps)
    swing = np.sin(2 * np.pi * k / PERIOD)[:, None]
    if number in (1, 2, 3):
        y = 3.0 if number == 3 else 2.0
        first, second = swing * [2.0, y], swing * [-2.0, y]
    elif number <= 8:
        x, y = _OFFSETS[number - 4]
        first, second = np.tile([0.0, y], (steps, 1)), np.tile([x, 1.0], (steps, 1))
    elif number == 9:
        rng = np.random.default_rng(SEED)
        noise = [rng.uniform(-w, w, steps) for w in (2, 1000, 2, 1000)]
        first, second = np.stack(noise[:2], 1), np.stack(noise[2:], 1)
        first[steps // 2 :], second[steps // 2 :] = (-1.9, -422), (-1.5, 299)
    elif number <= 14:
        y = _OFFSETS[number - 10][1]
        first = np.stack([1e-3 * k, np.full(steps, float(y))], 1)
        second = np.tile([-2.0, 2.0], (steps, 1))
    else:
        first = np.tile([0.0, float(_OFFSETS[number - 15][1])], (steps, 1))
        second = swing * [-2.0, 2.0]
    return PlanarTest(number, first, second)


def run_planar(test: PlanarTest, settings: KinematicSettings) -> dict[str, Any]:
    """Figures of one run.

    Returns:
        sigma [rad]: sum of |dq_i| where its sign changed; e1: sum of |e| of level 1 [m];
        psi: last step with an entry of 1e-6 or more, None if it is the last of the run;
        augmented: share of steps with a second-order term, per end effector; box: largest
        violation of the shoulder's box [m]; trace: norms of both errors, every TRACE steps.
    """
    model = planar_robot()
    levels = planar_levels(model, test.shoulder_box)
    solver = TaskSolver(model, levels, settings, joint_limits=False)
    q, last = START.copy(), np.zeros(4)
    sigma = integral = beyond = 0.0
    moving = unsolved = 0
    augmented = np.zeros(2)
    trace = []
    ends = [level.tasks[0] for level in levels[-2:]]
    for k, (first, second) in enumerate(zip(test.first, test.second, strict=True)):
        targets: dict[str, Any] = {"ef2": first, "ef3": second, "ef1": SHOULDER_BOX}
        step = solver.step(q, targets)
        errors = [
            float(np.linalg.norm(target - task.current(model)))
            for target, task in zip((first, second), ends, strict=True)
        ]
        integral += errors[0]
        if test.shoulder_box:
            at = levels[0].tasks[0].current(model)
            beyond = max(
                beyond, float(np.max(np.maximum(SHOULDER_BOX[0] - at, at - SHOULDER_BOX[1])))
            )
        if k:
            sigma += float(np.abs(step[np.sign(step) != np.sign(last)]).sum())
        if np.abs(step).max() >= _STILL:
            moving = k + 1
        augmented += solver.solver.augmented[-2:] or (False, False)
        if solver.solver.last is not None:
            unsolved += solver.solver.last.unsolved
        if k % TRACE == 0:
            trace.append(errors)
        last, q = step, q + step
    return {
        "sigma": sigma,
        "e1": integral,
        "psi": moving if moving < len(test.first) else None,
        "augmented": list(augmented / len(test.first)),
        "box_m": beyond,
        "unsolved": unsolved,
        "trace": trace,
    }
