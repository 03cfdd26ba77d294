"""A run made up for the tests of figures: its log, and what the controller said."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ghc_controller.robot.library import find_robot
from ghc_sim_bridge.analysis.analysis import Analysis, analyse
from ghc_sim_bridge.logs.controller_trace import ControllerTrace
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

DT = 1e-3
JOINTS = tuple(f"joint_{k}" for k in range(1, 8))


def made_up(
    folder: Path, scenario: str, names: tuple[str, ...] = JOINTS, robot: Path | None = None
) -> tuple[Analysis, ControllerTrace]:
    """A log of smoothly moving joints with one torque step, and matching priorities."""
    plan = make_plan(load_scenario(scenario), RunOptions(), folder)
    time = np.arange(round(plan.duration / DT)) * DT
    phase = np.linspace(0.0, 1.0, len(names))
    q = 0.4 * np.sin(0.3 * time[:, None] + phase) + 0.5
    v = 0.12 * np.cos(0.3 * time[:, None] + phase)
    torque = 5.0 * q
    torque[len(torque) // 2 :, 2] += 3.0
    contact = np.zeros((len(time), 6))
    contact[:, 2] = np.where(time > 5.0, 20.0, 0.0)
    log = folder / "log.npz"
    np.savez(
        log,
        time=time,
        q=q,
        v=v,
        acceleration=-0.3 * v,
        torque=torque,
        commanded=torque,
        source=np.zeros(len(time), np.uint8),
        epoch=np.zeros(len(time), np.uint32),
        cycle_time=np.full(len(time), 5e-4),
        wrench_tool=contact,
        joint_names=np.array(names),
        control_dt=DT,
    )
    analysis = analyse(plan, log, robot or find_robot("kuka_lwr"))
    trace = ControllerTrace(tasks=("end_effector", "elbow", "posture"))
    for t in np.arange(0.0, plan.duration, 0.01):
        rise = float(np.clip((t - plan.phases[0].end) / 2.0, 0.0, 1.0))
        trace.time.append(float(t))
        trace.alpha.append([rise, 1.0 - rise, 0.0, rise, 0.0, 0.0, 1.0, 1.0, 0.0])
        trace.errors.append([0.1, 0.1, 0.1])
        trace.time_step.append(1e-4)
    trace.counts = {"qp_failures": 0, "fallback_ticks": 0}
    return analysis, trace
