"""docs/reliability.md, made from the report of a campaign."""

# ruff: noqa: E501 - lines of a page

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

_HEAD = """# Reliability

Faults injected over DDS into the running nodes, and what came of them. `make faults` makes this page and `results/faults/faults.json`; `make faults ARGS=--quick` runs a part of the rows once.

Bridge and controller run in real time as by hand (`arming:=request`, torque rate limit 1000 Nm/s, watchdog 20 ms), KUKA LWR, control period 5 ms ("1 kHz": 1 ms). A process of its own listens to `joint_states` and `joint_commands` and judges what was commanded and applied; forged messages are told from true ones by the order of their joints. Most faults come while the arm swings to and fro between two targets. A row holds when every run of it keeps its limits, no node is dead, and no number on the wire is not finite.

- **torque**, **speed**: largest applied torque and joint velocity, of the limits of the URDF; at most 1 and 2 (4 where a forged obstacle pushes the arm).
- **rate**: largest change of an applied torque between two periods [Nm/s at the control period], at most 1000 over every edge. **commanded**: the same of what controllers sent, over states that they answered; not judged, since two of them in turn jump.
- **hold**: from the last command before the longest silence to the first state under a hold [ms of the bridge's clock], at most 20 ms and two periods. Only where the controller is killed in motion.
- **recovery**: wall time from the end of the fault until a state is answered and a request is served, the slowest run [s].
- **dropped**: control periods that the bridge was too late for, all runs together: starvation by the machine, not by the fault.
- **refused**: messages that the nodes counted as rejected, as of diagnostics once a second, all runs together. Forged messages that are sound in themselves (repeats, efforts) are not among them.
- **latched**: runs that ended in a latched fault, which was then reset. Where this is no stated outcome the row does not hold.

"""
_MISSING = """
## Not in this table

- Rows of pushing with 30 N against a table: the generators' faults were injected into an arm before an obstacle, with a contact that is off.
- Delay, loss and cut links between hosts: they need network namespaces, and are a campaign of their own.
- A full disk: a matter of the recorder alone, tested there.
- An hour of random faults: `make soak`.
"""


def write_page(report: Mapping[str, Any], path: Path) -> None:
    """Write the page of a full campaign."""
    rows = report["rows"]
    text = _HEAD
    text += f"**{report['held']} of {len(rows)} rows hold, {report['runs']} runs.**\n"
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
    path.write_text(text + _MISSING, encoding="utf-8")


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
