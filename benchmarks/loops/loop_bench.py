"""Round trips over DDS: nodes as processes in lockstep, without and with the generators."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.loops import loop_generators
from benchmarks.steps.pace import Pace, TakenByHost
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.ros.experiment_nodes import executable_of
from ghc_sim_bridge.run.cpu_placement import lockstep_placement
from ghc_sim_bridge.run.domain import DomainLock
from ghc_sim_bridge.run.processes import NodeProcesses

FORMULATION = ghc.Settings().formulation

SCENE = "kuka_lwr"  # and the robot of that name
CONTROL_DT = 1e-3  # [s]
_BRIDGE = "sim_bridge"
_SETTLING = 500  # [cycles] at the start: discovery, first calls
_DEADLINE = 180.0  # [s] wall


@dataclass(frozen=True, slots=True)
class LoopCase:
    """Which executor the nodes use, and whether both generators are part of the loop."""

    executor: str
    generators: bool

    @property
    def title(self) -> str:
        """The case in words."""
        return f"executor {self.executor}" + (", with generators" if self.generators else "")


CASES = (LoopCase("events", False), LoopCase("single", False), LoopCase("events", True))


def run_loop_bench(
    folder: Path,
    duration: float,
    rounds: int,
    pace: Pace,
    tell: Callable[[str], None],
    cases: Sequence[LoopCase] = CASES,
) -> Iterator[dict[str, Any]]:
    """One row per case from `rounds` runs of `duration` [s] simulated, in turns.

    On a shared host also the real time factor of the run from which the host took least.
    """
    cycles: dict[LoopCase, list[tuple[float, np.ndarray]]] = {case: [] for case in cases}
    for number in range(rounds):
        for case in cases:
            pace.take()
            tell(f"lockstep over DDS, {case.title}, {number + 1} of {rounds}")
            name = case.executor + ("_generators" if case.generators else "")
            cycles[case].append(_cycle_times(folder / name, case, duration))
    for case, runs in cycles.items():
        times = np.concatenate([times for _, times in runs])
        # To a percent: among runs that were left alone the fastest one counts.
        least_taken, calmest = min(runs, key=lambda run: (round(run[0], 2), run[1].mean()))
        yield {
            "executor": case.executor,
            "generators": case.generators,
            "formulation": FORMULATION,
            "control_dt": CONTROL_DT,
            "steps": len(times),
            "steps_per_second": round(1.0 / float(np.mean(times)), 1),
            "real_time_factor": round(CONTROL_DT / float(np.mean(times)), 3),
            "calmest_real_time_factor": round(CONTROL_DT / float(np.mean(calmest)), 3),
            "taken_by_host": round(float(np.mean([taken for taken, _ in runs])), 3),
            "least_taken_by_host": round(least_taken, 3),
            "cycle_p50_us": round(float(np.percentile(times, 50.0)) * 1e6, 1),
            "cycle_p99_us": round(float(np.percentile(times, 99.0)) * 1e6, 1),
        }


def _cycle_times(folder: Path, case: LoopCase, duration: float) -> tuple[float, np.ndarray]:
    """Share of CPU time that the host took during one run, and wall seconds of each of its cycles,
    from the bridge's own log."""
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "log.npz"
    log.unlink(missing_ok=True)
    domain = DomainLock()
    environment = os.environ | {
        "ROS_DOMAIN_ID": str(domain.id),
        "ROS_LOG_DIR": str(folder),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    parameters = _parameters(folder, case, duration + _SETTLING * CONTROL_DT)
    # rclpy's own executor works long after each message, while the partner could go on.
    shared = case.executor == "events"
    placement = lockstep_placement(parameters, domain.id) if shared else {}
    planner = (
        loop_generators.published_schedule(domain.id, folder)
        if case.generators
        else nullcontext(_no_wait)
    )
    try:
        host = TakenByHost()
        with (
            planner as wait_until_received,
            NodeProcesses(folder, environment, placement) as nodes,
        ):
            # The bridge comes last: it lets time run.
            for name in sorted(parameters, key=lambda name: name == _BRIDGE):
                if name == _BRIDGE:
                    wait_until_received(nodes.check)
                nodes.start(name, *executable_of(name), _arguments(parameters[name]))
            _wait_for(log, nodes)
            taken = host.share()
    finally:
        domain.release()
    return taken, FullRateLog.load(log).cycle_time[_SETTLING:]


def _parameters(folder: Path, case: LoopCase, stop_time: float) -> dict[str, dict[str, Any]]:
    """Node -> its parameters."""
    bridge = {
        "scene": SCENE,
        "control_dt": CONTROL_DT,
        "stop_time": stop_time,
        "lockstep_timeout": _DEADLINE,
        "log_file": folder / "log.npz",
    }
    controller = {"robot": SCENE, "formulation": FORMULATION, "control_dt": CONTROL_DT}
    nodes: dict[str, dict[str, Any]] = {_BRIDGE: bridge, "controller": controller}
    if case.generators:
        bridge["scene"] = loop_generators.SCENE
        controller["robot"] = loop_generators.write_robot(SCENE, folder)
        controller["wait_for_bounds"] = loop_generators.WAIT_FOR
        nodes |= {name: dict(values) for name, values in loop_generators.NODES.items()}
    for values in nodes.values():
        values["executor"] = case.executor
    return nodes


def _no_wait(_check: Callable[[], None]) -> None:
    pass


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
            raise ghc.GhcError(f"the run did not end within {_DEADLINE:g} s; see {log.parent}")
        time.sleep(0.1)
