"""Runs the rows on three hosts, as a process on that of the operator."""

from __future__ import annotations

import json
import os
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from ghc_msgs.msg import ControllerMode

import ghc_controller as ghc
from benchmarks.faults.campaign import YOUTH, recovery
from benchmarks.faults.judge import Run, broken, figures
from benchmarks.faults.session import TARGETS
from benchmarks.faults.wire import Wire
from benchmarks.hosts.conditions import Conditions
from benchmarks.hosts.namespaces import Network
from benchmarks.hosts.rows import ROWS, HostRow
from benchmarks.hosts.session import HostsSession
from ghc_controller.types import Array

CONTROL_DT = 5e-3  # [s]
SWING, REST = 0.6, 0.4  # [-] of a row's time: in motion, towards a target that stands


def run_rows(network: Network, folder: Path, quick: bool) -> list[dict[str, Any]]:
    """Run and evaluate each row once; results by row."""
    rows = [row for row in ROWS if row.quick or not quick]
    done: list[tuple[HostRow, Run, float]] = []
    with HostsSession(folder, CONTROL_DT, network) as session:
        for name in ("sim_bridge", "controller"):
            session.start(name)
        session.ready()
        session.spin(YOUTH)
        path = session.start_monitor()
        for row in rows:
            done.append((row, *_safe_run(session, network, row)))
            print(f"{row.name}: recovered {done[-1][1].recovery}", flush=True)
        session.stop("monitor")
    wire = Wire.load(path)
    limit = ghc.load_robot("kuka_lwr").model.limits.velocity
    entries = []
    for row, run, error in done:
        values = figures(run, wire, CONTROL_DT, limit)
        part = wire.between(run.fault, run.fault + row.lasts)
        trips = 1e3 * round_trips(part)
        entries.append(
            {"row": row.name, "conditions": asdict(row.conditions), "lasts_s": row.lasts}
            | {key: value for key, value in asdict(run).items() if key in _KEPT}
            | values
            | {
                "error_mm": round(1e3 * error, 3),
                "answered": len(trips) / max(len(part.stamp), 1),
                "round_trip_ms": [float(x) for x in np.percentile(trips, (50, 95, 100))]
                if len(trips)
                else [],
                "broken": broken(run, values, row.limits, may_latch=False, control_dt=CONTROL_DT),
            }
        )
    return entries


_KEPT = ("recovery", "latched", "dead", "dropped", "refused", "problem")


def round_trips(wire: Wire) -> Array:
    """[s] from each state to the first command that answers it, as the robot's host sees both."""
    sent = dict(zip(wire.stamp.tolist(), wire.wall.tolist(), strict=True))
    heard: dict[float, float] = {}
    for stamp, wall in zip(wire.command_stamp.tolist(), wire.command_wall.tolist(), strict=True):
        if stamp in sent:
            heard.setdefault(stamp, wall - sent[stamp])
    return np.array(list(heard.values()))


def _safe_run(session: HostsSession, network: Network, row: HostRow) -> tuple[Run, float]:
    """A row; one that does not come to its end does not hold."""
    begin = time.monotonic()
    try:
        return _run(session, network, row)
    except AssertionError as error:
        network.set(Conditions())
        now = time.monotonic()
        return Run(row.name, 0, begin, begin, now, None, False, (), 0, 0, str(error)), 0.0


def _run(session: HostsSession, network: Network, row: HostRow) -> tuple[Run, float]:
    """A row; and the error of the task [m] at its end, as the operator hears it."""
    session.ready()
    dropped, refused = session.count("sim_bridge", "dropped_periods"), session.refused()
    session.ask("end_effector > elbow > posture", 0.2)
    begin = time.monotonic()
    session.swing(1.0)
    network.set(row.conditions)
    fault = time.monotonic()
    session.swing(SWING * row.lasts)
    session.refer(TARGETS[0])
    session.spin(max(fault + row.lasts - time.monotonic(), 0.0))
    error = next((t.error_norm for t in session.report.tasks if t.name == "end_effector"), 0.0)
    network.set(Conditions())
    latched = session.mode.mode == ControllerMode.LATCHED
    if latched:
        session.call("controller/reset_fault")
    took = recovery(session)
    end = time.monotonic()
    dead = tuple(n for n, p in session.processes.items() if p.exit_code is not None)
    lost = max(session.count("sim_bridge", "dropped_periods") - dropped, 0)
    more = max(session.refused() - refused, 0)
    return Run(row.name, 0, begin, fault, end, took, latched, dead, lost, more), error


def main() -> int:
    """Arguments: the hosts, the pipe to the hub, the folder of results, "quick" or ""."""
    enter, control, folder, quick = sys.argv[1:]
    entries = run_rows(Network(json.loads(enter), Path(control)), Path(folder), bool(quick))
    report = {"rows": entries, "control_dt_s": CONTROL_DT, "load": os.getloadavg()[1]}
    path = Path(folder) / "hosts.json"
    path.write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
