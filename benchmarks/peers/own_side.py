"""This project's controller with one formulation."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.peers.problem import DT, Array, PeerProblem
from benchmarks.peers.robots import peer_robot

_RAMP = 1.0  # [s] longer than a segment
_FALLBACK = ghc.StepStatus.FALLBACK


class OwnSide:
    """`Controller.step`, with references, gate and report."""

    def __init__(self, problem: PeerProblem, urdf: str, formulation: str, order: str) -> None:
        """The controller of a case; `order` is "strict", or "ramp" with two active orders."""
        del urdf  # the product has its own
        self._problem = problem
        self._ramp = order == "ramp"
        robot = peer_robot(problem.robot, len(problem.tasks))
        if robot.model.joint_names != problem.joints:
            raise ValueError(f"joints {robot.model.joint_names} found, {problem.joints} expected")
        robot.model.limits = replace(robot.model.limits, torque=problem.torque_limit)
        settings = ghc.Settings(formulation=formulation, control_dt=DT, torque_rate_limit=0.0)
        self.controller = ghc.Controller(robot, settings)
        self._states = [
            ghc.RobotState(row * DT, q, v)
            for row, (q, v) in enumerate(zip(problem.q, problem.v, strict=True))
        ]
        self._watched: list[tuple[int, int, bool]] = []

    def enter(self, row: int) -> None:
        """Restart with the goals of the segment that begins with a state."""
        segment = int(self._problem.segment[row])
        controller = self.controller
        controller.reset()
        controller.start(self._states[row])
        for task in self._problem.tasks:
            controller.set_reference(task.name, self._problem.goals[task.name][segment])
        if self._ramp:
            names = [task.name for task in self._problem.tasks]
            swapped = " > ".join([names[1], names[0], *names[2:]])
            controller.change_hierarchy(swapped, start=self._states[row].time, duration=_RAMP)

    def step(self, row: int) -> Array | None:
        """Torque (a,) [Nm] at a state; None where the joints would brake."""
        result = self.controller.step(self._states[row])
        return None if result.status is _FALLBACK else result.torque

    def watch(self, row: int) -> Array | None:
        """The same, with its QPs and pivots counted in `facts`."""
        solver = self.controller.formulation.solver
        before = solver.qps
        torque = self.step(row)
        unsolved = self.controller.report().result.status is not ghc.StepStatus.SOLVED
        self._watched.append((solver.qps - before, solver.step_pivots, unsolved))
        return torque

    def facts(self) -> dict[str, Any]:
        """Means per step so far."""
        qps, pivots, unsolved = np.mean(np.array(self._watched, dtype=float), axis=0)
        self._watched.clear()
        return {"qps": qps, "pivots": pivots, "not_solved_share": unsolved}
