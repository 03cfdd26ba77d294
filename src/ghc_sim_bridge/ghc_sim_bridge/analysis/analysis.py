"""From what a run left to its figures: one value that summary, plots and tables share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import Robot, load_robot_config
from ghc_controller.types import Array
from ghc_sim_bridge.analysis.metrics import (
    LimitCheck,
    PhasedFigure,
    jerk_integral,
    limit_violations,
    peak_torque_jump,
    peak_torque_rate,
    phase_end_speed,
)
from ghc_sim_bridge.analysis.rest import PhaseRest, moving_coordinates, rest_of_phase, rest_window
from ghc_sim_bridge.analysis.task_errors import RunHistory, gravity_torques, recompute_history
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scenario.plan import RunPlan

_SAMPLE_PERIOD = 0.01  # [s] between two rows at which the tasks are evaluated


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits in force during a run, in the order of the log's joints."""

    position_lower: Array  # (n,) [rad]
    position_upper: Array  # (n,) [rad]
    velocity: Array  # (n,) [rad/s]
    torque: Array  # (n,) [Nm] of the motors
    torque_bound: Array | None  # (n,) [Nm] a tighter bound of the scenario
    bound_around_gravity: bool  # whether that bound holds for torque - gravity
    torque_rate: float  # [Nm/s]; 0 = off


@dataclass(frozen=True, slots=True)
class Analysis:
    """A run and everything computed from its log."""

    plan: RunPlan
    log: FullRateLog
    robot: Robot
    limits: Limits
    history: RunHistory  # every 10 ms and at the end of each phase
    phase_errors: tuple[Mapping[str, float], ...]  # task -> error at the end of the phase
    torque_rate: PhasedFigure  # [Nm/s]
    torque_jump: PhasedFigure  # [Nm]
    start_up_jump: float  # [Nm] from the bridge's hold to the first command
    jerk: PhasedFigure  # [rad/s^2]
    end_speed: PhasedFigure  # [rad/s] over the last second of each phase
    rest: tuple[PhaseRest, ...]  # motion left at the end of each phase
    violations: Mapping[str, float]  # limit -> largest relative excess [-]


def analyse(plan: RunPlan, log_file: Path, robot_file: Path) -> Analysis:
    """Read log and robot of a run and compute its figures."""
    log = FullRateLog.load(log_file)
    robot = load_robot_config(robot_file)
    spans = [(phase.start, phase.end) for phase in plan.phases]
    ends = np.array([_last_row(log, end) for _, end in spans])
    step = max(1, round(_SAMPLE_PERIOD / log.control_dt))
    rows = np.unique(np.concatenate([np.arange(0, len(log.time), step), ends]))
    history = recompute_history(log, robot, plan.scenario.references, rows)
    at_end = [int(np.searchsorted(rows, end)) for end in ends]
    limits = _limits(plan, log, robot)
    return Analysis(
        plan=plan,
        log=log,
        robot=robot,
        limits=limits,
        history=history,
        phase_errors=tuple(
            {task.name: float(task.error[k]) for task in history.tasks} for k in at_end
        ),
        torque_rate=peak_torque_rate(log.time, log.torque, log.control_dt, spans),
        torque_jump=peak_torque_jump(log.time, log.torque, spans),
        start_up_jump=float(np.abs(log.torque[0] - history.gravity[0]).max()),
        jerk=jerk_integral(log.time, log.acceleration, spans),
        end_speed=phase_end_speed(log.time, log.v, spans),
        rest=_rest(plan, log, history),
        violations=limit_violations(_checks(log, limits, robot)),
    )


def analyse_folder(plan: RunPlan) -> Analysis:
    """The figures of a run that has been made, from the files of its folder."""
    changed = plan.folder / "robot.yaml"
    robot = changed if changed.is_file() else find_robot(plan.scenario.robot)
    return analyse(plan, plan.folder / "log.npz", robot)


def _rest(plan: RunPlan, log: FullRateLog, history: RunHistory) -> tuple[PhaseRest, ...]:
    """Motion of the joints, and of the base where it floats, at the end of each phase."""
    velocity = moving_coordinates(log)
    references = [(history.time, task.reference) for task in history.tasks]
    return tuple(
        rest_of_phase(log.time, velocity, references, planned.end, rest_window(planned.phase.hold))
        for planned in plan.phases
    )


def _last_row(log: FullRateLog, end: float) -> int:
    return max(0, int(np.searchsorted(log.time, end - 1e-9)) - 1)


def _limits(plan: RunPlan, log: FullRateLog, robot: Robot) -> Limits:
    order = [robot.model.joint_index(name) for name in log.joint_names]
    read = robot.model.limits
    controller = plan.parameters["controller"]
    velocity = read.velocity[order]
    if controller.get("velocity_limit", 0.0) > 0.0:
        velocity = np.minimum(velocity, float(controller["velocity_limit"]))
    bound = None
    if controller.get("torque_bound", 0.0) > 0.0:
        bound = np.full(len(order), float(controller["torque_bound"]))
    return Limits(
        position_lower=read.position_lower[order],
        position_upper=read.position_upper[order],
        velocity=velocity,
        torque=read.torque[order],
        torque_bound=bound,
        bound_around_gravity=controller.get("torque_bound_around") == "gravity",
        torque_rate=_torque_rate_limit(plan, robot),
    )


def _torque_rate_limit(plan: RunPlan, robot: Robot) -> float:
    """The tighter one of controller and bridge [Nm/s]; 0 = off in both."""
    limits = [
        float(plan.parameters[node]["torque_rate_limit"]) for node in ("controller", "sim_bridge")
    ]
    if limits[0] < 0.0:
        limits[0] = float(np.max(robot.torque_rate))
    return min((limit for limit in limits if limit > 0.0), default=0.0)


def _checks(log: FullRateLog, limits: Limits, robot: Robot) -> list[LimitCheck]:
    checks = [
        LimitCheck("position", log.q, limits.position_lower, limits.position_upper),
        LimitCheck("velocity", log.v, -limits.velocity, limits.velocity),
        LimitCheck("torque", log.torque, -limits.torque, limits.torque),
    ]
    if limits.torque_bound is not None:
        center = gravity_torques(log, robot) if limits.bound_around_gravity else 0.0
        bound = limits.torque_bound
        checks.append(LimitCheck("torque_bound", log.torque - center, -bound, bound))
    if limits.torque_rate > 0.0:
        rate = np.diff(log.torque, axis=0) / log.control_dt
        bound = np.full(rate.shape[1], limits.torque_rate)
        checks.append(LimitCheck("torque_rate", rate, -bound, bound))
    return checks
