"""Runs the rows of the matrix over DDS and evaluates the recordings of the monitor.

`make faults`, ARGS="--quick" for the short campaign, `--only WORDS` for rows with these words,
`--runs N`; `--resume` goes on where an interrupted campaign with the same options ended. Writes
results/faults/faults.json and docs/reliability.md; --quick writes neither (quick.json instead)
and repeats a few rows that broke limits of time alone, once, with new nodes.
"""

from __future__ import annotations

import argparse
import json
import os
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
from benchmarks.faults import (
    generator_rows,
    message_rows,
    odometry_rows,
    process_rows,
    request_rows,
    wrench_rows,
)
from benchmarks.faults.generator_rows import GENERATORS
from benchmarks.faults.judge import (
    PROBES,
    SWING,
    Run,
    after_one,
    broken,
    figures,
    missed,
    only_slow,
    usually_missed,
)
from benchmarks.faults.page import write_page
from benchmarks.faults.row import Bench, Row
from benchmarks.faults.session import Session
from benchmarks.faults.subject import Subject
from benchmarks.faults.wire import Wire
from benchmarks.models import install_model
from ghc_controller.robot.library import find_robot
from ghc_controller.ros.qos import SCHEDULE_QOS
from ghc_controller.types import Array

ROOT = Path(__file__).resolve().parents[2]
ROWS: tuple[Row, ...] = (
    *process_rows.ROWS,
    *message_rows.ROWS,
    *wrench_rows.ROWS,
    *odometry_rows.ROWS,
    *request_rows.ROWS,
    *generator_rows.ROWS,
)
PERIOD = {bench: 1e-3 if bench is Bench.FAST else 5e-3 for bench in Bench}  # [s]
PATIENCE = 10.0  # [s] wall, for a recovery; a restart has been waited for by then
YOUTH = 6.0  # [s] wall; so long a bridge still looks for an older one, see docs/interfaces.md
FEW = 3  # [-] rows that a quick campaign repeats
CHUNK = 12  # [-] rows for which the same nodes run, at most: what an interruption costs


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign; 0 when every row holds, else 1."""
    options = _parser().parse_args(arguments)
    rows = [row for row in ROWS if options.only in row.name]
    rows = [row for row in rows if row.quick or not options.quick]
    runs = options.runs or (1 if options.quick else 3)
    output = ROOT / "results" / "faults"
    output.mkdir(parents=True, exist_ok=True)
    part = output / "part.json"
    if not options.resume:
        part.unlink(missing_ok=True)
    judged = run_rows(rows, runs, output / "logs", part)
    slow = slow_rows(rows, judged) if options.quick else []
    if 0 < len(slow) <= FEW:
        print(f"once more, since only slow: {', '.join(row.name for row in slow)}", flush=True)
        part.unlink()
        judged |= run_rows(slow, runs, output / "logs" / "again", part)
    report = {
        "rows": [judged[row.name] for row in rows],
        "runs": sum(len(entry["runs"]) for entry in judged.values()),
        "held": sum(entry["holds"] for entry in judged.values()),
        "load": os.getloadavg()[1],
        "control_dt_s": {bench.value: PERIOD[bench] for bench in Bench},
    }
    partial = (options.quick or options.only) and not options.update
    path = output / ("quick.json" if partial else "faults.json")
    if options.update:
        report = updated(json.loads(path.read_text(encoding="utf-8")), report)
    path.write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    part.unlink()
    if not partial:
        write_page(report, ROOT / "docs" / "reliability.md")
    print(f"{report['held']} of {len(report['rows'])} rows hold, {report['runs']} runs: {path}")
    return int(report["held"] != len(report["rows"]))


def run_rows(rows: Sequence[Row], runs: int, logs: Path, part: Path) -> dict[str, dict[str, Any]]:
    """Judged rows by name; those that the file `part` has are not run again.

    Nodes are started anew for every CHUNK rows of a bench, and `part` is written behind each.
    """
    judged: dict[str, dict[str, Any]] = {}
    if part.exists():
        found = json.loads(part.read_text(encoding="utf-8"))
        judged = {name: row for name, row in found.items() if len(row["runs"]) == runs}
    for bench in Bench:
        left = [row for row in rows if row.bench is bench and row.name not in judged]
        for first in range(0, len(left), CHUNK):
            chosen = left[first : first + CHUNK]
            judged |= _run_bench(bench, chosen, runs, logs / f"{bench.value}_{chosen[0].slug}")
            draft = part.with_suffix(".tmp")
            draft.write_text(json.dumps(judged, allow_nan=False), encoding="utf-8")
            draft.replace(part)
            print(f"{len(judged)} of {len(rows)} rows: {part}", flush=True)
    part.touch()
    return judged


def slow_rows(rows: Sequence[Row], judged: dict[str, dict[str, Any]]) -> list[Row]:
    """Rows that do not hold, all their runs for limits of time alone."""
    return [
        row
        for row in rows
        if not judged[row.name]["holds"]
        and all(only_slow(run["broken"], run["problem"]) for run in judged[row.name]["runs"])
    ]


def updated(report: dict[str, Any], newer: dict[str, Any]) -> dict[str, Any]:
    """A report in which repeated rows replace their first runs."""
    again = {row["row"]: row for row in newer["rows"]}
    rows = [again.get(row["row"], row) for row in report["rows"]]
    return newer | {
        "rows": rows,
        "runs": sum(len(row["runs"]) for row in rows),
        "held": sum(row["holds"] for row in rows),
        "again": sorted({*report.get("again", []), *again}),
    }


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="make faults", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a part of the rows, once each")
    parser.add_argument("--only", default="", help="rows whose name contains this")
    parser.add_argument(
        "--update",
        action="store_true",
        help="with --only: these rows take the place of those of the last full campaign",
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on where an interrupted campaign ended"
    )
    parser.add_argument("--runs", type=int, default=0, help="runs of each row, seeds 0 to N - 1")
    return parser


def _run_bench(
    bench: Bench, rows: Sequence[Row], runs: int, folder: Path
) -> dict[str, dict[str, Any]]:
    done: list[Run] = []
    with Session(folder, PERIOD[bench], bench.subject) as session:
        path = _start(session, bench, folder)
        for row in rows:
            for seed in range(runs):
                run = _safe_run(session, bench, row, seed)
                done.append(run)
                print(f"{row.name} [{seed}]: recovered {run.recovery}, {run.problem}", flush=True)
        session.stop("monitor")
    wire = Wire.load(path)
    limits = _limits(bench.subject, session.names["states"])
    usual = usually_missed(wire, done, PERIOD[bench])
    judged: dict[str, dict[str, Any]] = {}
    for row in rows:
        entries = []
        for run in (run for run in done if run.row == row.name):
            values = figures(run, wire, PERIOD[bench], *limits)
            wrong = broken(run, values, row.limits, row.latches, PERIOD[bench])
            if row.single:
                after = missed(wire, run.fault, run.fault + 1.0, PERIOD[bench])
                values |= {"missed_after": after, "missed_undisturbed": usual}
                wrong += after_one(run, values, row.limits)
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


def _limits(subject: Subject, joints: Sequence[str]) -> tuple[Array, Array]:
    """Velocity and torque limits in the order of these joints."""
    model = ghc.load_robot(subject.robot).model
    order = [model.joint_names.index(name) for name in joints]
    return model.velocity_limit[order], model.torque_limit[order]


def _start(session: Session, bench: Bench, folder: Path) -> Path:
    """Start all nodes of a bench; returns the file of the monitor."""
    if bench is Bench.CONTACT:
        session.defaults["sim_bridge"] = {"scene": "kuka_lwr_obstacle"}
        session.defaults["controller"] = {"robot": _robot_with_contact(folder)}
    if bench is Bench.BASE:
        install_model("icub-models")
    if bench is Bench.TOUCH:
        session.defaults["sim_bridge"] = {"scene": "kuka_lwr_plane"}
        session.defaults["controller"] = {"wait_for_contacts": "[tool]"}
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
    """The arm with a contact at its tool, inactive until a plan activates it."""
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
    session.ask(session.subject.orders[0], 0.2)
    begin = time.monotonic()
    if row.moving:
        session.swing(SWING + float(rng.uniform(0.0, 0.4)))
    else:
        session.spin(0.3)
    probes = [recovery(session) or PATIENCE for _ in range(PROBES if row.single else 0)]
    fault, problem = time.monotonic(), ""
    try:
        row.inject(session, rng)
    except AssertionError as error:
        problem = str(error)
    works_on = recovery(session) if row.single else None
    session.spin(row.after)
    latched = session.mode.mode == ControllerMode.LATCHED
    if latched:
        session.call("controller/reset_fault")
    took = recovery(session)
    end = time.monotonic()
    dead = tuple(
        name for name, process in list(session.processes.items()) if process.exit_code is not None
    )
    for name in dead:
        session.processes.pop(name)
    lost = max(session.count("sim_bridge", "dropped_periods") - dropped, 0)
    more = max(session.refused() - refused, 0)
    return Run(
        row.name, seed, begin, fault, end, took, latched, dead, lost, more, problem, works_on,
        max(probes, default=0.0),
    )  # fmt: skip


def recovery(session: Session) -> float | None:
    """Time until states are answered and a request is served [s]."""
    began = time.monotonic()
    count, said = session.answered, len(session.statuses)
    request = f"recovery {began}"
    try:
        session.until(lambda: session.answered > count, "an answer", PATIENCE)
        session.ask_with_id(request, session.subject.orders[1])
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
