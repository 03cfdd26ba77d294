"""docs/reliability.md, made from the report of a campaign."""

# ruff: noqa: E501 - lines of a page

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.hosts.page import SECTION as HOSTS
from benchmarks.soak.section import STACK

_HEAD = """# Reliability

Faults injected over DDS into the running nodes, and what came of them. `make faults` makes this page and `results/faults/faults.json`; `make faults ARGS=--quick` runs a part of the rows once, `make faults ARGS="--runs 3 --resume"` goes on where an interrupted campaign of three runs ended: nodes are started anew for every twelve rows, and `results/faults/part.json` has those that are done.

Bridge and controller run in real time as by hand (`arming:=request`, torque rate limit 1000 Nm/s, watchdog 20 ms), KUKA LWR, control period 5 ms ("1 kHz": 1 ms); odometry is forged for iCub on both feet. A process of its own listens to `joint_states` and `joint_commands` and judges what was commanded and applied; forged messages are told from true ones by the order of their joints. Most faults come while the arm swings to and fro between two targets. A row holds when every run of it keeps its limits, no node is dead, and no number on the wire is not finite.

- **torque**, **speed**: largest applied torque and joint velocity, of the limits of the URDF; at most 1 and 2 (4 where a forged obstacle pushes the arm).
- **rate**: largest change of an applied torque between two periods [Nm/s at the control period], at most 1000 over every edge. **commanded**: the same of what controllers sent, over states that they answered; not judged, since two of them in turn jump.
- **hold**: from the last command before the longest silence to the first state under a hold [ms of the bridge's clock], at most 20 ms and two periods. Only where the controller is killed in motion.
- **recovery**: wall time from the end of the fault until a state is answered and a request is served, the slowest run [s].
- **dropped**: control periods that the bridge was too late for, all runs together: starvation by the machine, not by the fault.
- **refused**: messages that the nodes counted as rejected, as of diagnostics once a second, all runs together. Forged messages that are sound in themselves (repeats, efforts) are not among them.
- **latched**: runs that ended in a latched fault, which was then reset. Where this is no stated outcome the row does not hold.

"""
_SINGLE = """
## After one message

Every row "ONE ..." above once more. **works on**: wall time from the message until a state is answered and a request is served, the slowest run [ms]; at most 100 ms, or what the slowest of five such requests took in undisturbed motion just before it (**undisturbed**), where the machine is slower than that. **missed**: share of control periods without an answer in the second after the message [%]; at most that of undisturbed motion in the same campaign (**usual**, 99th percentile over the motion before each fault, of the same nodes) and one in a hundred.

| message | works on | undisturbed | missed | usual | holds |
|---|---|---|---|---|---|
"""
_MISSING = """
## Not in this table

- Rows of pushing with 30 N against a table: the generators' faults were injected into an arm before an obstacle, with a contact that is off.
- Every row of the first campaign is here or named above. Of three of them the form is another one: 3000 contact names are 500, as many as are sent in the time of a row; an epoch in the header of a state is one on `sim_bridge/epoch`, which states carried then; killing in a transition is killing in fast motion, with transitions at its begin and end.
"""


def write_page(report: Mapping[str, Any], path: Path) -> None:
    """Write the page of a full campaign."""
    rows = report["rows"]
    text = _HEAD
    text += f"**{report['held']} of {len(rows)} rows hold, {report['runs']} runs.**\n"
    if "load" in report:
        text += (
            f"\nMean number of programs that wanted the machine's {os.cpu_count()} cores in the last "
            f"five minutes of the campaign: {report['load']:.1f}.\n"
        )
    if report.get("again"):
        text += f"\nRun again on their own after that: {', '.join(report['again'])}.\n"
    for group in dict.fromkeys(row["group"] for row in rows):
        text += f"\n## {group.capitalize().replace('_', ' ')}\n\n"
        text += "| fault | runs | torque | rate | commanded | speed | hold | recovery | dropped | "
        text += "refused | latched | holds |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n"
        text += "".join(_line(row) for row in rows if row["group"] == group)
    wrong = [row for row in rows if not row["holds"]]
    if wrong:
        text += "\n## Rows that do not hold\n\n"
        for row in wrong:
            reasons = sorted({reason for run in row["runs"] for reason in run["broken"]})
            text += f"- {row['row']}: {'; '.join(reasons)}\n"
    text += _single_messages([row for row in rows if row["row"].startswith("ONE ")])
    text += _MISSING
    before = path.read_text(encoding="utf-8") if path.exists() else ""
    for section in (HOSTS, STACK):  # written by other commands
        text = section.keep(text, before)
    path.write_text(text, encoding="utf-8")


def _single_messages(rows: Sequence[Mapping[str, Any]]) -> str:
    """The table of what a single forged message costs."""
    if not rows:
        return ""
    text = _SINGLE
    for row in rows:
        runs = row["runs"]
        works = [run["works_on"] for run in runs]
        cells = [
            row["row"].removeprefix("ONE "),
            "never" if None in works else f"{1e3 * max(works):.0f}",
            f"{1e3 * max(run['undisturbed'] for run in runs):.0f}",
            f"{100 * max(run.get('missed_after', 1.0) for run in runs):.1f}",
            f"{100 * max(run.get('missed_undisturbed', 0.0) for run in runs):.1f}",
            "yes" if row["holds"] else "**no**",
        ]
        text += "| " + " | ".join(cells) + " |\n"
    return text


def _line(row: Mapping[str, Any]) -> str:
    runs = row["runs"]

    def most(name: str) -> float:
        return float(max(run[name] for run in runs))

    recoveries = [run["recovery"] for run in runs]
    recovery = "never" if None in recoveries else f"{max(recoveries):.2f}"
    held = f"{most('hold_after_ms'):.0f}" if row["limits"]["hold"] is not None else ""
    cells = [
        row["row"].replace("|", "\\|"),
        f"{len(runs)}",
        f"{most('torque_share'):.2f}",
        f"{most('rate_nm_per_s'):.0f}",
        f"{most('commanded_rate_nm_per_s'):.0f}",
        f"{most('speed_share'):.2f}",
        held,
        recovery,
        f"{sum(run['dropped'] for run in runs)}",
        f"{sum(run['refused'] for run in runs)}",
        f"{sum(run['latched'] for run in runs) or ''}",
        "yes" if row["holds"] else "**no**",
    ]
    return "| " + " | ".join(cells) + " |\n"
