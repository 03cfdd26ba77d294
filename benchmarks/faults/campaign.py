"""Runs the rows of the matrix over DDS and judges them by what the monitor saw.

`make faults`, ARGS="--quick" for the short campaign, `--only WORDS` for rows with these words,
`--runs N`. Writes results/faults/faults.json and docs/reliability.md; --quick writes neither
(results/faults/quick.json instead).
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from ghc_msgs.msg import ContactSchedule, ControllerMode

import ghc_controller as ghc
from benchmarks.faults import generator_rows, message_rows, process_rows, request_rows
from benchmarks.faults.generator_rows import GENERATORS
from benchmarks.faults.judge import Run, broken, figures
from benchmarks.faults.page import write_page
from benchmarks.faults.row import Bench, Row
from benchmarks.faults.session import Session
from benchmarks.faults.wire import Wire
from ghc_controller.robot.library import find_robot
from ghc_controller.ros.qos import SCHEDULE_QOS

ROOT = Path(__file__).resolve().parents[2]
ROWS: tuple[Row, ...] = (
    *process_rows.ROWS,
    *message_rows.ROWS,
    *request_rows.ROWS,
    *generator_rows.ROWS,
)
PERIOD = {Bench.ARM: 5e-3, Bench.FAST: 1e-3, Bench.CONTACT: 5e-3}  # [s]
PATIENCE = 10.0  # [s] wall, for a recovery; a restart has been waited for by then
YOUTH = 6.0  # [s] wall; so long a bridge still looks for an older one, see docs/interfaces.md
SWING = 0.8  # [s] wall of fast motion before a fault


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign; 0 when every row holds, else 1."""
    options = _parser().parse_args(arguments)
    rows = [row for row in ROWS if options.only in row.name]
    rows = [row for row in rows if row.quick or not options.quick]
    runs = options.runs or (1 if options.quick else 3)
    output = ROOT / "results" / "faults"
    output.mkdir(parents=True, exist_ok=True)
    judged: dict[str, dict[str, Any]] = {}
    for bench in Bench:
        chosen = [row for row in rows if row.bench is bench]
        if chosen:
            judged |= _run_bench(bench, chosen, runs, output / "logs" / bench.value)
    report = {
        "rows": [judged[row.name] for row in rows],
        "runs": sum(len(entry["runs"]) for entry in judged.values()),
        "held": sum(entry["holds"] for entry in judged.values()),
        "control_dt_s": {bench.value: PERIOD[bench] for bench in Bench},
    }
    partial = options.quick or options.only
    path = output / ("quick.json" if partial else "faults.json")
    path.write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    if not partial:
        write_page(report, ROOT / "docs" / "reliability.md")
    print(f"{report['held']} of {len(rows)} rows hold, {report['runs']} runs: {path}")
    return int(report["held"] != len(rows))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="make faults", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a part of the rows, once each")
    parser.add_argument("--only", default="", help="rows whose name contains this")
    parser.add_argument("--runs", type=int, default=0, help="runs of each row, seeds 0 to N - 1")
    return parser


def _run_bench(
    bench: Bench, rows: Sequence[Row], runs: int, folder: Path
) -> dict[str, dict[str, Any]]:
    done: list[Run] = []
    with Session(folder, PERIOD[bench]) as session:
        path = _start(session, bench, folder)
        for row in rows:
            for seed in range(runs):
                run = _safe_run(session, bench, row, seed)
                done.append(run)
                print(f"{row.name} [{seed}]: recovered {run.recovery}, {run.problem}", flush=True)
        session.stop("monitor")
    wire = Wire.load(path)
    velocity_limit = ghc.load_robot("kuka_lwr").model.limits.velocity
    judged: dict[str, dict[str, Any]] = {}
    for row in rows:
        entries = []
        for run in (run for run in done if run.row == row.name):
            values = figures(run, wire, PERIOD[bench], velocity_limit)
            wrong = broken(run, values, row.limits, row.latches, PERIOD[bench])
            about = {k: v for k, v in asdict(run).items() if k not in ("row", "begin", "end")}
            entries.append(about | values | {"broken": wrong})
        judged[row.name] = {
            "row": row.name,
            "group": row.group,
            "bench": bench.value,
            "limits": asdict(row.limits),
            "may_latch": row.latches,
            "holds": not any(entry["broken"] for entry in entries),
            "runs": entries,
        }
    return judged


def _start(session: Session, bench: Bench, folder: Path) -> Path:
    """Start all nodes of a bench; where the monitor will write."""
    if bench is Bench.CONTACT:
        session.defaults["sim_bridge"] = {"scene": "kuka_lwr_obstacle"}
        session.defaults["controller"] = {"robot": _robot_with_contact(folder)}
    for name in _nodes(bench):
        session.start(name)
    session.ready()
    session.spin(YOUTH)
    path = session.start_monitor()
    if bench is Bench.CONTACT:
        publisher = session.node.create_publisher(
            ContactSchedule, "constraints/contact_schedule", SCHEDULE_QOS
        )
        publisher.publish(ContactSchedule(contact="tool", times=[0.0], lower=[0.0], upper=[0.0]))
        session.spin(1.0)
    return path


def _nodes(bench: Bench) -> tuple[str, ...]:
    return ("sim_bridge", "controller") + (GENERATORS if bench is Bench.CONTACT else ())


def _robot_with_contact(folder: Path) -> Path:
    """The arm with a contact at its tool, which is off until a plan says otherwise."""
    source = find_robot("kuka_lwr")
    values = yaml.safe_load(source.read_text(encoding="utf-8"))
    contact = {"name": "tool", "frame": "tool", "points": [[0, 0, 0]], "normal": [0, 0, 1]}
    values |= {"urdf": str(source.parent / values["urdf"]), "contacts": [contact]}
    path = folder / "robot.yaml"
    path.write_text(yaml.safe_dump(values), encoding="utf-8")
    return path


def _safe_run(session: Session, bench: Bench, row: Row, seed: int) -> Run:
    """A run; one after which the robot is not driven again gets new nodes, and does not hold."""
    begin = time.monotonic()
    try:
        return _run(session, bench, row, seed)
    except AssertionError as error:
        for name in [name for name in session.processes if name != "monitor"]:
            session.kill(name)
        now = time.monotonic()
        return Run(row.name, seed, begin, begin, now, None, False, (), 0, 0, str(error))


def _run(session: Session, bench: Bench, row: Row, seed: int) -> Run:
    rng = np.random.default_rng([seed, *row.name.encode()])
    for name in _nodes(bench):  # a row that killed a node costs the next one nothing
        if name not in session.processes:
            session.start(name)
    session.ready()
    dropped = session.count("sim_bridge", "dropped_periods")
    refused = session.refused()
    session.ask("end_effector > elbow > posture", 0.2)
    begin = time.monotonic()
    if row.moving:
        session.swing(SWING + float(rng.uniform(0.0, 0.4)))
    else:
        session.spin(0.3)
    fault, problem = time.monotonic(), ""
    try:
        row.inject(session, rng)
    except AssertionError as error:
        problem = str(error)
    session.spin(row.after)
    latched = session.mode.mode == ControllerMode.LATCHED
    if latched:
        session.call("controller/reset_fault")
    recovery = _recovery(session)
    end = time.monotonic()
    dead = tuple(
        name for name, process in list(session.processes.items()) if process.exit_code is not None
    )
    for name in dead:
        session.processes.pop(name)
    lost = max(session.count("sim_bridge", "dropped_periods") - dropped, 0)
    more = max(session.refused() - refused, 0)
    return Run(row.name, seed, begin, fault, end, recovery, latched, dead, lost, more, problem)


def _recovery(session: Session) -> float | None:
    """How long it takes until states are answered and a request is served [s]."""
    began = time.monotonic()
    count, said = session.answered, len(session.statuses)
    request = f"recovery {began}"
    try:
        session.until(lambda: session.answered > count, "an answer", PATIENCE)
        session.ask_with_id(request, "elbow > end_effector > posture")
        session.until(
            lambda: any(s.id == request and not s.reason for s in session.statuses[said:]),
            "the status",
            PATIENCE,
        )
    except AssertionError:
        return None
    return time.monotonic() - began


if __name__ == "__main__":
    sys.exit(main())
