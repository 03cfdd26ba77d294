"""The part of docs/reliability.md about several hosts."""

# ruff: noqa: E501 - lines of a page

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.sections import Section

SECTION = Section("hosts: written by `make hosts`", before="## Not in this table")

_HEAD = """## Several hosts

`make hosts`: robot (bridge), controller and operator in three network namespaces, each with shared memory of its own, so that all data are UDP over a hub. The hub is a program, since not every kernel has netem; it delays, loses and cuts frames of both directions, and of discovery too. Control period {period:g} ms, watchdog 20 ms, the arm swings to and fro and then goes to a target that stands. A monitor on the robot's host judges torque, rate and speed as above.

- **answered**: states of the robot that got a command, while the condition lasts. **round trip**: from a state to its command on the robot's host, median, 95 % and largest [ms]; twice the delay, and what machine and hub add.
- **error**: distance of the end effector from its target at the end of the condition [mm]; a cut leaves it where it was held.
- **recovery**: wall time until a request is served again [s].

Load of the machine during the run (mean number of programs that wanted its {cores} cores in five minutes): {load:.1f}. Above {cores} the round trips are those of the machine as well.

**{held} of {count} rows hold.**

| network | torque | rate | speed | answered | round trip | error | hold | recovery | latched | holds |
|---|---|---|---|---|---|---|---|---|---|---|
"""


def write_section(report: Mapping[str, Any], cores: int, document: Path) -> None:
    """Put the results into the document."""
    rows = report["rows"]
    text = _HEAD.format(
        period=1e3 * report["control_dt_s"],
        cores=cores,
        load=report["load"],
        held=sum(not row["broken"] for row in rows),
        count=len(rows),
    )
    text += "".join(_line(row) for row in rows)
    wrong = [row for row in rows if row["broken"]]
    if wrong:
        text += "\nRows that do not hold:\n\n"
        text += "".join(f"- {row['row']}: {'; '.join(row['broken'])}\n" for row in wrong)
    before = document.read_text(encoding="utf-8")
    document.write_text(SECTION.put(before, text), encoding="utf-8")


def _line(row: Mapping[str, Any]) -> str:
    cut = row["conditions"]["cut"]
    trips = " / ".join(f"{value:.1f}" for value in row["round_trip_ms"])
    recovery = "never" if row["recovery"] is None else f"{row['recovery']:.2f}"
    cells = [
        row["row"],
        f"{row['torque_share']:.2f}",
        f"{row['rate_nm_per_s']:.0f}",
        f"{row['speed_share']:.2f}",
        "" if cut else f"{100.0 * row['answered']:.0f} %",
        "" if cut else trips,
        f"{row['error_mm']:.1f}",
        f"{row['hold_after_ms']:.0f}" if cut else "",
        recovery,
        "1" if row["latched"] else "",
        "**no**" if row["broken"] else "yes",
    ]
    return "| " + " | ".join(cells) + " |\n"
