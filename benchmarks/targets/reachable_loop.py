"""Reachable references of a target stream, alone or followed by the controller in closed loop."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ghc_controller as ghc
from benchmarks.targets.target_streams import Channel, Curve
from ghc_controller.reachable import ReachableReference
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator

DT = 1e-3  # [s]
PLAN = 10  # steps between plans


@dataclass(frozen=True, slots=True)
class Case:
    """A robot, its scene and the task that has a stream.

    In closed loop a posture task below it gets the posture of the reference. Other tasks are left
    out: what they want is not what the stream asks for.
    """

    robot: str | Path
    scene: str | Path
    task: str
    posture: str = "posture"

    @property
    def hierarchy(self) -> str:
        """Order in closed loop."""
        return f"{self.task} > {self.posture}"


class Feeder:
    """Passes samples to a reference when they arrive."""

    def __init__(
        self, case: Case, channel: Channel, curve: Curve, end: float, seed: int, stamped: bool
    ) -> None:
        robot = ghc.load_robot(case.robot)
        self.reference = ReachableReference(robot, [case.task], posture=case.posture)
        self._task, self._stamped = case.task, stamped
        self._samples = channel.samples(curve, end, seed)
        self._next = 0
        self.rejected = 0

    def until(self, now: float) -> None:
        """All samples that arrived by `now` [s]."""
        while self._next < len(self._samples) and self._samples[self._next][0] <= now:
            arrival, stamp, position = self._samples[self._next]
            self._next += 1
            try:
                self.reference.add(self._task, position, arrival, stamp if self._stamped else None)
            except ghc.GhcError:
                self.rejected += 1


def run_reference(
    case: Case, curve: Curve, end: float, channel: Channel, seed: int, q: Array
) -> tuple[Array, Feeder]:
    """(T, 3, n) q, v, a of the reference at every ms, and what fed it; stamped samples."""
    feeder = Feeder(case, channel, curve, end, seed, True)
    rows: list[Array] = []
    for k in range(round(end / DT / PLAN)):
        now = k * PLAN * DT
        feeder.until(now)
        feeder.reference.plan(ghc.RobotState(now, q, np.zeros(len(q))))
        if feeder.reference.has_begun:
            rows.append(feeder.reference.joint_motion)
    return np.concatenate(rows), feeder


@dataclass(frozen=True, slots=True)
class LoopRun:
    """What happened at each of T control periods."""

    error: Array  # (T,) [m] to the curve at the same time
    step: Array  # (T,) [Nm] largest change of a torque from the period before

    def after(self, time: float) -> LoopRun:
        """From a time [s] on."""
        first = round(time / DT)
        return LoopRun(self.error[first:], self.step[first:])


def run_loop(
    case: Case,
    curve: Curve,
    end: float,
    channel: Channel,
    seed: int,
    formulation: str,
    stamped: bool = True,
) -> LoopRun:
    """Run the controller with default settings in the simulator."""
    settings = ghc.Settings(formulation=formulation, hierarchy=case.hierarchy)
    controller = ghc.Controller.for_robot(case.robot, settings)
    simulator = Simulator(case.scene, control_dt=DT, joint_names=controller.model.joint_names)
    controller.start(simulator.state())
    feeder = Feeder(case, channel, curve, end, seed, stamped)
    index = controller.robot.task_names.index(case.task)
    errors, torques = [], []
    for k in range(round(end / DT)):
        state = simulator.state()
        feeder.until(state.time)
        if k % PLAN == 0:
            for reference in feeder.reference.plan(state):
                controller.add_reference(reference)
        torque = controller.step(state).torque
        torques.append(torque.copy())
        position = controller.robot.tasks[index].current(controller.model)
        errors.append(float(np.linalg.norm(position - curve(state.time))))
        simulator.step(torque)
    steps = np.abs(np.diff(np.array(torques), axis=0, prepend=[torques[0]])).max(axis=1)
    return LoopRun(np.array(errors), steps)
