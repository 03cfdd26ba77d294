"""T20 rebuilt on iCub, 38 degrees of freedom: hierarchy C, kinematics alone.

Feet and left hand stay, the right hand follows a target that swings in and out of reach, and the
center of mass stays in a large box (above the hand) and in a small one (below it). The paper has
HRP-2Kai and gives no numbers; those here are chosen.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.models import install_model
from ghc_controller.kinematics import KinematicSettings, Level, TaskSolver
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.center_of_mass import CenterOfMassTask
from ghc_controller.tasks.frame import FramePoseTask, FramePositionTask
from ghc_controller.types import Array

PERIODS = {10000: 5000, 3000: 1500}  # steps: steps per oscillation of the target
SWING = np.array([0.15, 0.6, -0.6])  # [m] amplitude of the right hand's target
TRACE = 50  # [steps] between stored points
_FIXED = ("l_sole", "r_sole", "l_hand_dh_frame")
_HAND = "r_hand_dh_frame"
_LARGE, _SMALL = (0.09, 0.05), (0.05, 0.0)  # [m] half size along x; beyond the soles along y
_HIGH = 10.0  # [m] half size along z: no bound
_POSTURE = {  # [rad] both sides; all other joints 0
    "hip_pitch": 0.5,
    "knee": -0.9,
    "ankle_pitch": -0.4,
    "shoulder_pitch": -0.5,
    "shoulder_roll": 0.5,
    "elbow": 0.9,
}


def icub() -> tuple[RobotModel, Array]:
    """The robot on a floating base and its first configuration (nq,)."""
    install_model("icub-models")
    model = ghc.load_robot("icub").model
    q = np.zeros(model.nq)
    q[6] = 1.0
    for joint, angle in _POSTURE.items():
        for side in "lr":
            q[7 + model.joint_index(f"{side}_{joint}")] = angle
    return model, q


class HumanoidTest:
    """Levels and targets of T20."""

    def __init__(self) -> None:
        self.model, self.start = icub()
        model = self.model
        self.fixed = [FramePoseTask(name, model, name, 1.0, 1.0) for name in _FIXED]
        self.hand = FramePositionTask("hand", model, _HAND, 1.0, 1.0)
        self.large = CenterOfMassTask("large_box", model, 1.0, 1.0)
        self.small = CenterOfMassTask("small_box", model, 1.0, 1.0)
        model.update(self.start, np.zeros(model.nv))
        self._still: dict[str, Any] = {t.name: t.current(model).copy() for t in self.fixed}
        soles = [self._still[name][:3] for name in _FIXED[:2]]
        middle = 0.5 * (soles[0] + soles[1])
        middle[0] = self.large.current(model)[0]
        apart = 0.5 * abs(soles[0][1] - soles[1][1])
        for box, (x, y) in ((self.large, _LARGE), (self.small, _SMALL)):
            half = np.array([x, apart + y, _HIGH])
            self._still[box.name] = (middle - half, middle + half)
        self._hand = self.hand.current(model).copy()

    def levels(self) -> list[Level]:
        """Hierarchy C below the trust region and the joint limits."""
        return [
            Level(*self.fixed),
            Level(self.large, bounded=True),
            Level(self.hand),
            Level(self.small, bounded=True),
        ]

    def targets(self, phase: float) -> dict[str, Any]:
        """Targets at a phase [rad] of the oscillation."""
        return self._still | {"hand": self._hand + SWING * np.sin(phase)}


def run_humanoid(settings: KinematicSettings, steps: int, period: int) -> dict[str, Any]:
    """Figures of one run.

    Returns:
        sigma [rad]; hand: sum of the error norms of the right hand [m]; box_m: largest violation
        of the large box [m]; augmented: share of steps per level; cpu_us, cpu_p99_us: processor
        time of a step, median and 99th percentile; trace: error of the hand [m] and which levels
        are augmented, every TRACE steps.
    """
    test = HumanoidTest()
    model = test.model
    solver = TaskSolver(model, test.levels(), settings)
    q, last = test.start.copy(), np.zeros(model.nv)
    sigma = hand = beyond = 0.0
    augmented, unsolved = np.zeros(4), 0
    times, trace = np.empty(steps), []
    for k in range(steps):
        targets = test.targets(2 * np.pi * k / period)
        begin = time.thread_time()
        step = solver.step(q, targets)
        times[k] = time.thread_time() - begin
        error = float(np.linalg.norm(targets["hand"] - test.hand.current(model)))
        hand += error
        lower, upper = targets["large_box"]
        at = test.large.current(model)
        beyond = max(beyond, float(np.max(np.maximum(lower - at, at - upper))))
        record = solver.solver.last
        if record is not None:
            unsolved += record.unsolved
        if k:
            sigma += float(np.abs(step[np.sign(step) != np.sign(last)]).sum())
        augmented += solver.solver.augmented
        if k % TRACE == 0:
            trace.append([error, *map(float, solver.solver.augmented)])
        last, q = step, model.integrate(q, step)
    return {
        "sigma": sigma,
        "hand": hand,
        "box_m": beyond,
        "augmented": list(augmented / steps),
        "unsolved": unsolved,
        "cpu_us": 1e6 * float(np.median(times)),
        "cpu_p99_us": 1e6 * float(np.quantile(times, 0.99)),
        "trace": trace,
    }
