"""Closed loop of controller and simulator, with recorded data; no ROS."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

import ghc_controller as ghc
from benchmarks.compare.operations import law_operations
from benchmarks.compare.qp_counter import QpCounter
from ghc_controller.hierarchy.priorities import Candidate
from ghc_controller.tasks.python.frame_avoidance import FrameAvoidanceTask
from ghc_controller.types import Array
from ghc_sim_bridge import SimulationDiverged, Simulator

LARGEST_SPEED = 100.0  # [rad/s] norm of all joints: beyond it a run has stopped
LARGEST_TORQUE = 2e4  # [Nm] likewise
PROBE_PERIOD = 0.1  # [s] between two control problems that are kept

Act = Callable[[ghc.Controller, float], None]  # controller after it observed a state, time [s]


class Span(NamedTuple):
    """Part of a run over which errors are taken by the levels of one order."""

    hierarchy: str
    alpha: Array  # (k, k)
    start: float  # [s]
    end: float  # [s]


@dataclass(frozen=True, slots=True)
class Loop:
    """A run before its start."""

    controller: ghc.Controller
    simulator: Simulator
    spans: tuple[Span, ...]
    act: Act | None = None
    held: int = 0  # accelerations that contacts keep at rest
    lowest: float = 0.0  # [m] of a floating base: below it the robot has fallen


class Change(NamedTuple):
    """A control problem at which an order is left for another one."""

    problem: ghc.ControlProblem
    before: Array  # (k, k)
    after: Array  # (k, k)


@dataclass(slots=True)
class Record:
    """What happened at each of T steps; row k as in metrics.py of the bridge."""

    time: list[float] = field(default_factory=list)  # [s]
    errors: list[Array] = field(default_factory=list)  # (k,) norms [m] or [rad]
    torque: list[Array] = field(default_factory=list)  # (a,) [Nm]
    velocity: list[Array] = field(default_factory=list)  # (n,) [rad/s]
    acceleration: list[Array] = field(default_factory=list)  # (n,) [rad/s^2] of the simulation
    changing: list[bool] = field(default_factory=list)  # several orders, or a new one
    qps: list[int] = field(default_factory=list)
    pivots: list[int] = field(default_factory=list)
    operations: list[float] = field(default_factory=list)  # of law and QPs
    unsolved: int = 0  # steps that are RELAXED or FALLBACK
    fallback: int = 0
    excess: float = 0.0  # [rad] largest one over a position limit
    problems: list[ghc.ControlProblem] = field(default_factory=list)  # every PROBE_PERIOD
    changes: list[Change] = field(default_factory=list)
    stopped: float | None = None  # [s] where the run diverged or the robot fell


def run_loop(loop: Loop) -> Record:
    """Run to the end of the last span, or to where the robot diverges or falls."""
    controller, simulator = loop.controller, loop.simulator
    counter, record = QpCounter(controller), Record()
    dt, end = controller.settings.control_dt, loop.spans[-1].end
    every = max(1, round(PROBE_PERIOD / dt))
    formulation, d = controller.formulation.name, controller.model.nv - loop.held
    before: tuple[Candidate, ...] = ()
    tick = 0
    while simulator.time < end - 1e-9:
        state = simulator.state()
        if loop.act is not None:
            controller.observe(state)
            loop.act(controller, state.time)
        counter.take()
        result = controller.step(state)
        qps, pivots, operations = counter.take()
        candidates = controller.priorities.in_force.candidates
        found = _change(before, candidates)
        if found is not None:
            record.changes.append(Change(controller.problem(), *found))
        elif tick % every == 0 and len(candidates) == 1:
            record.problems.append(controller.problem())
        before = candidates
        record.time.append(state.time)
        record.errors.append(_errors(controller))
        record.torque.append(result.torque.copy())
        record.velocity.append(state.v.copy())
        record.changing.append(found is not None or len(candidates) > 1)
        record.qps.append(qps)
        record.pivots.append(pivots)
        law = law_operations(formulation, d, controller.stack.starts, candidates)
        record.operations.append(operations + law)
        record.unsolved += result.status is not ghc.StepStatus.SOLVED
        record.fallback += result.status is ghc.StepStatus.FALLBACK
        try:
            simulator.step(result.torque)
        except SimulationDiverged:
            record.stopped = state.time
        record.acceleration.append(simulator.acceleration.copy())
        if record.stopped is None and _is_lost(loop, result.torque):
            record.stopped = state.time
        if record.stopped is not None:
            break
        record.excess = max(record.excess, _excess(loop))
        tick += 1
    return record


def _errors(controller: ghc.Controller) -> Array:
    """(k,) norms; a task that keeps a distance has none while it is farther away."""
    found = []
    for index, task in enumerate(controller.robot.tasks):
        error = controller.stack.error_of(index)
        if isinstance(task, FrameAvoidanceTask):
            error = np.maximum(error, 0.0)
        found.append(np.linalg.norm(error))
    return np.array(found)


def _change(
    before: tuple[Candidate, ...], now: tuple[Candidate, ...]
) -> tuple[Array, Array] | None:
    """The order that was alone in force and the one that came, None where nothing changed."""
    if len(before) != 1:
        return None
    new = [each.alpha for each in now if not np.array_equal(each.alpha, before[0].alpha)]
    return (before[0].alpha.copy(), new[0].copy()) if new else None


def _is_lost(loop: Loop, torque: Array) -> bool:
    state = loop.simulator.state()
    if loop.lowest > 0.0 and state.q[2] < loop.lowest:
        return True
    return bool(np.linalg.norm(torque) > LARGEST_TORQUE or np.linalg.norm(state.v) > LARGEST_SPEED)


def _excess(loop: Loop) -> float:
    """Largest excess over a position limit [rad]."""
    limits = loop.controller.model.limits
    q = loop.simulator.state().q[-len(limits.position_upper) :]
    return float(np.maximum(q - limits.position_upper, limits.position_lower - q).max(initial=0.0))
