"""Round trips over DDS: bridge and controller as processes in lockstep, executor by executor."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.pace import Pace
from ghc_controller.errors import GhcError
from ghc_sim_bridge.full_rate_log import FullRateLog
from ghc_sim_bridge.processes import NodeProcesses
from ghc_sim_bridge.ros_domain import DomainLock

EXECUTORS = ("events", "single")
SCENE = "kuka_lwr"
FORMULATION = "balanced"
CONTROL_DT = 1e-3  # [s]
_SETTLING = 500  # [cycles] at the start: discovery, first calls
_DEADLINE = 180.0  # [s] wall; the first start compiles the controller's kernels


def run_loop_bench(
    folder: Path, duration: float, rounds: int, pace: Pace, tell: Callable[[str], None]
) -> Iterator[dict[str, Any]]:
    """One row per executor from `rounds` runs of `duration` [s] simulated, in turns."""
    cycles: dict[str, list[np.ndarray]] = {executor: [] for executor in EXECUTORS}
    for number in range(rounds):
        for executor in EXECUTORS:
            pace.take()
            tell(f"lockstep over DDS, executor {executor}, {number + 1} of {rounds}")
            cycles[executor].append(_cycle_times(folder / executor, executor, duration))
    for executor, runs in cycles.items():
        times = np.concatenate(runs)
        yield {
            "executor": executor,
            "formulation": FORMULATION,
            "scene": SCENE,
            "control_dt": CONTROL_DT,
            "steps": len(times),
            "steps_per_second": round(1.0 / float(np.mean(times)), 1),
            "real_time_factor": round(CONTROL_DT / float(np.mean(times)), 3),
            "cycle_p50_us": round(float(np.percentile(times, 50.0)) * 1e6, 1),
            "cycle_p99_us": round(float(np.percentile(times, 99.0)) * 1e6, 1),
        }


def _cycle_times(folder: Path, executor: str, duration: float) -> np.ndarray:
    """Wall seconds of each cycle of one run, from the bridge's own log."""
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "log.npz"
    log.unlink(missing_ok=True)
    domain = DomainLock()
    environment = os.environ | {
        "ROS_DOMAIN_ID": str(domain.id),
        "ROS_LOG_DIR": str(folder),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    bridge = {
        "scene": SCENE,
        "control_dt": CONTROL_DT,
        "stop_time": duration + _SETTLING * CONTROL_DT,
        "lockstep_timeout": _DEADLINE,
        "log_file": log,
        "executor": executor,
    }
    controller = {
        "robot": SCENE,
        "formulation": FORMULATION,
        "control_dt": CONTROL_DT,
        "executor": executor,
    }
    try:
        with NodeProcesses(folder, environment) as nodes:
            nodes.start("sim_bridge", "ghc_sim_bridge", "sim_bridge", _arguments(bridge))
            nodes.start("controller", "ghc_controller", "controller", _arguments(controller))
            _wait_for(log, nodes)
    finally:
        domain.release()
    return FullRateLog.load(log).cycle_time[_SETTLING:]


def _arguments(parameters: dict[str, Any]) -> list[str]:
    arguments = ["--ros-args"]
    for name, value in parameters.items():
        arguments += ["-p", f"{name}:={value}"]
    return arguments


def _wait_for(log: Path, nodes: NodeProcesses) -> None:
    deadline = time.monotonic() + _DEADLINE
    while not log.exists():
        nodes.check()
        if time.monotonic() > deadline:
            raise GhcError(f"the run did not end within {_DEADLINE:g} s; see {log.parent}")
        time.sleep(0.1)
