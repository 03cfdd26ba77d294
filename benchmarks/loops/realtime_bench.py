"""`make bench ARGS="--only realtime"`: the loop over DDS beside a bare one of the same bytes.

In lockstep: wall time of a cycle of bridge and controller, over that of two bare rclpy nodes. In
real time at 1 kHz: periods without a new command, beside those of the bare nodes at the same
priority, all of them on the processor that stalls least. Both loops run in turns.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.loops.stalls import calmest_processor, permitted_priority
from benchmarks.machine import load_average, machine_facts
from ghc_controller.report.valid_json import json_text
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.ros.experiment_nodes import executable_of
from ghc_sim_bridge.run.cpu_placement import lockstep_placement
from ghc_sim_bridge.run.domain import DomainLock
from ghc_sim_bridge.run.processes import NodeProcesses

PERIOD = 1e-3  # [s]
_ROBOT = "kuka_lwr"
_SETTLING = 500  # [-] cycles at the start
_DISCOVERY = 10.0  # [s] at most until the controller answers
_PATIENCE = 120.0  # [s] beyond the duration of a run
_FULL, _QUICK = (60.0, 5), (3.0, 1)  # [s] of a run, runs of each
_LOCKSTEP = 4.0  # [s] of a run in lockstep, simulated or of the bare loop


def run_realtime(output: Path, *, quick: bool) -> dict[str, Any]:
    """Measure, print, write `realtime.json`; its content."""
    duration, rounds = _QUICK if quick else _FULL
    found: dict[str, list[float]] = {name: [] for name in ("bare", "stack", "bare_lost", "lost")}
    before, priority = load_average(), permitted_priority()
    cpu = calmest_processor(priority)
    for number in range(rounds):
        print(f"bench: real time, {number + 1} of {rounds}", file=sys.stderr, flush=True)
        bare = _ping_pong(output, min(duration, _LOCKSTEP), 0.0, 0, None)
        found["bare"].append(bare["seconds"] / bare["rounds"])
        found["stack"].append(_lockstep_cycle(output, min(duration, _LOCKSTEP)))
        bare = _ping_pong(output, duration, PERIOD, priority, cpu)
        found["bare_lost"].append(bare["lost"] / (duration / PERIOD))
        found["lost"].append(_lost(output, duration, priority, cpu))
    middle = {name: float(np.median(values)) for name, values in found.items()}
    results = {
        "machine": machine_facts(),
        "load_average": {"before": before, "after": load_average()},
        "duration": duration,
        "priority": priority,
        "cpu": cpu,
        "runs": found,
        "lockstep_ratio": round(middle["stack"] / middle["bare"], 3),
        "lost_percent": round(100.0 * middle["lost"], 4),
        "bare_lost_percent": round(100.0 * middle["bare_lost"], 4),
    }
    cycle, bare_cycle = 1e6 * middle["stack"], 1e6 * middle["bare"]
    lost, bare_lost = results["lost_percent"], results["bare_lost_percent"]
    print(
        f"\nLockstep, KUKA: {cycle:.0f} us a cycle, bare {bare_cycle:.0f} us: ratio "
        f"{results['lockstep_ratio']:.2f}\n"
        f"1 kHz, priority {priority}, cpu {cpu}: {lost:.3f} % of periods without a new command, "
        f"bare {bare_lost:.3f} % (medians of {rounds} runs)"
    )
    output.mkdir(parents=True, exist_ok=True)
    (output / "realtime.json").write_text(json_text(results, 1) + "\n", encoding="utf-8")
    return results


@contextmanager
def _domain(folder: Path) -> Iterator[tuple[int, dict[str, str]]]:
    folder.mkdir(parents=True, exist_ok=True)
    domain = DomainLock()
    own = {"ROS_DOMAIN_ID": str(domain.id), "ROS_LOG_DIR": str(folder)}
    try:
        yield domain.id, os.environ | own | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    finally:
        domain.release()


def _ping_pong(
    folder: Path, duration: float, period: float, priority: int, cpu: int | None
) -> dict[str, float]:
    result = folder / "ping.json"
    result.unlink(missing_ok=True)
    command = [sys.executable, "-m", "benchmarks.loops.ping_pong"]
    ending = ["--priority", str(priority)]
    with _domain(folder) as (number, environment):
        # In turns on one processor, as the nodes of the stack.
        in_turns = lockstep_placement(("sim_bridge",), number).get("sim_bridge")
        cpus = in_turns if cpu is None else {cpu}

        def start(*arguments: str) -> subprocess.Popen[bytes]:
            process = subprocess.Popen([*command, *arguments, *ending], env=environment)
            if cpus:
                os.sched_setaffinity(process.pid, cpus)
            return process

        pong = start("pong")
        ping = start("ping", str(result), str(duration), str(period))
        try:
            ping.wait(duration + _PATIENCE)
        except subprocess.TimeoutExpired:
            raise ghc.GhcError("the bare loop did not end") from None
        finally:
            for process in (ping, pong):
                process.terminate()
                process.wait()
    counted: dict[str, float] = json.loads(result.read_text(encoding="utf-8"))
    return counted


def _lockstep_cycle(folder: Path, duration: float) -> float:
    """Mean wall time of a cycle [s]."""
    log = _run(folder, duration, {"executor": "events"}, {}, True)
    return float(log.cycle_time[_SETTLING:].mean())


def _lost(folder: Path, duration: float, priority: int, cpu: int) -> float:
    """Share of periods without a new command: none came, or the state had none of its own.

    Noise on the measured velocities makes every command another one.
    """
    noise = {"disturbance_seed": 1, "disturbance_push": 0.0, "disturbance_mass": 0.0}
    mode = {"mode": "realtime", **noise}
    both = {"realtime_priority": priority, "cpu": cpu}
    log = _run(folder, duration + _DISCOVERY, both, mode)
    given = np.flatnonzero(np.isfinite(log.commanded[:, 0]))
    periods = round(duration / PERIOD)
    if not len(given) or len(log.commanded) < given[0] + _SETTLING + periods:
        raise ghc.GhcError(f"the controller came too late; see {folder}")
    commanded = log.commanded[given[0] + _SETTLING :][: periods + 1]
    new = np.any(commanded[1:] != commanded[:-1], axis=1) & np.isfinite(commanded[1:, 0])
    return float(1.0 - new.mean())


def _run(
    folder: Path,
    duration: float,
    both: dict[str, Any],
    bridge: dict[str, Any],
    in_turns: bool = False,
) -> FullRateLog:
    path = folder / "log.npz"
    path.unlink(missing_ok=True)
    stop = duration + (_SETTLING + 1) * PERIOD
    of_bridge: dict[str, Any] = {
        "scene": _ROBOT,
        "control_dt": PERIOD,
        "stop_time": stop,
        "log_file": path,
    }
    of_controller: dict[str, Any] = {"robot": _ROBOT, "control_dt": PERIOD, "arming": "automatic"}
    nodes = {"controller": of_controller | both, "sim_bridge": of_bridge | both | bridge}
    deadline = time.monotonic() + stop + _PATIENCE
    with _domain(folder) as (number, environment):
        placement = lockstep_placement(nodes, number) if in_turns else {}
        with NodeProcesses(folder, environment, placement) as running:
            for name, values in nodes.items():
                given = [f"{key}:={value}" for key, value in values.items()]
                arguments = [part for each in given for part in ("-p", each)]
                running.start(name, *executable_of(name), ["--ros-args", *arguments])
            while not path.exists():
                running.check()
                if time.monotonic() > deadline:
                    raise ghc.GhcError(f"the run did not end; see {folder}")
                time.sleep(0.1)
    return FullRateLog.load(path)
