"""The judge of the fault campaign: what breaks a limit is found, what keeps it is not."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.faults.campaign import ROWS, run_rows, slow_rows, updated
from benchmarks.faults.judge import ENOUGH, TORQUE_LIMIT, Run, broken, figures, usually_missed
from benchmarks.faults.page import write_page
from benchmarks.faults.row import Limits
from benchmarks.faults.wire import Wire

DT = 5e-3  # [s]
VELOCITY_LIMIT = np.full(7, 2.0)  # [rad/s]
LAST = np.linspace(1.0, 2.0, 7)  # [Nm] from the command to a hold
RUN = Run("row", 0, 0.0, 0.5, 1.0, 0.01, False, (), 0)


def _wire() -> Wire:
    """A second of a robot whose torques move by 4 Nm in a period of 5 ms, 800 Nm/s."""
    stamp = np.arange(0.0, 1.0, DT)
    effort = np.outer(4.0 * (np.arange(len(stamp)) % 2), np.ones(7))
    return Wire(stamp, stamp, np.ones((len(stamp), 7)), effort, stamp, stamp, effort)


def _judged(wire: Wire, run: Run = RUN, limits: Limits | None = None) -> list[str]:
    return broken(run, figures(run, wire, DT, VELOCITY_LIMIT), limits or Limits(), False, DT)


def test_a_sound_run_holds() -> None:
    assert _judged(_wire()) == []


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"effort": 12.0}, "rate_nm_per_s"),
        ({"effort": 200.0}, "torque_share"),
        ({"effort": np.nan}, "not finite"),
        ({"velocity": 4.1}, "speed_share"),
        ({"velocity": np.inf}, "not finite"),
        ({"command_effort": np.nan}, "not finite"),
    ],
)
def test_one_number_is_enough(change: dict[str, float], word: str) -> None:
    wire = _wire()
    for name, value in change.items():
        getattr(wire, name)[100, 3] = value
        if name != "effort":
            wire = replace(wire)
    assert any(word in text for text in _judged(wire))


@pytest.mark.parametrize(
    ("run", "word"),
    [
        (replace(RUN, dead=("controller",)), "controller is dead"),
        (replace(RUN, recovery=None), "recovered after None"),
        (replace(RUN, recovery=3.0), "recovered after 3.0 s"),
        (replace(RUN, latched=True), "latched"),
        (replace(RUN, problem="the second bridge runs"), "second bridge"),
    ],
)
def test_what_became_of_the_nodes_counts(run: Run, word: str) -> None:
    assert any(word in text for text in _judged(_wire(), run))


@pytest.mark.parametrize(
    ("hold", "holds"), [(0.0, True), (0.02, True), (0.034, False), (0.06, False), (1.0, False)]
)
def test_a_hold_that_comes_late_is_found(hold: float, holds: bool) -> None:
    """Commands end at 0.4 s; the last one is applied for a while, then a hold, or none."""
    wire = _wire()
    last = wire.command_stamp <= 0.4
    effort = wire.effort.copy()
    effort[wire.stamp > 0.4] = effort[last][-1]
    effort[wire.stamp > 0.4 + hold] += 1.0
    again = wire.command_stamp > 0.8
    cut = replace(
        wire,
        effort=effort,
        command_stamp=wire.command_stamp[last | again],
        command_wall=wire.command_wall[last | again],
        command_effort=wire.command_effort[last | again],
    )
    assert (_judged(cut, limits=Limits(hold=0.02, rate=1e9)) == []) is holds


def test_a_robot_that_was_held_before_the_last_command_is_held(decay: float = 0.9) -> None:
    """The braking of a hold dies away, towards the last command as it happens."""
    wire = _wire()
    last = wire.command_stamp <= 0.4
    effort = wire.command_effort[last][-1] + np.outer(decay ** np.arange(len(wire.stamp)), LAST)
    commands = np.concatenate([wire.command_effort[last], wire.command_effort[-20:]])
    stamps = np.concatenate([wire.command_stamp[last], wire.command_stamp[-20:]])
    held = replace(
        wire, effort=effort, command_stamp=stamps, command_wall=stamps, command_effort=commands
    )
    assert held.hold_after(1000.0 * DT) == pytest.approx(DT)


def test_what_is_usually_missed_is_counted_before_faults_and_in_motion_only() -> None:
    """The second half of a second without commands is a fault, which begins there."""
    wire = _wire()
    half = slice(0, len(wire.stamp) // 2)
    wire = replace(
        wire,
        command_stamp=wire.command_stamp[half],
        command_wall=wire.command_wall[half],
        command_effort=wire.command_effort[half],
    )
    late = replace(RUN, begin=0.0, fault=1.0)
    at_rest = replace(RUN, begin=0.5, fault=0.8)
    many = [late] * ENOUGH
    assert usually_missed(wire, [*many, at_rest], DT) == pytest.approx(0.5, abs=0.02)
    assert usually_missed(wire, [late, at_rest], DT) == 1.0, "too few for a percentile"


def test_a_resumed_campaign_runs_nothing_again(tmp_path: Path) -> None:
    """Rows of as many runs are taken from the file; no node is started for them."""
    part = tmp_path / "part.json"
    done = {row.name: {"row": row.name, "runs": [{}, {}]} for row in ROWS[:5]}
    part.write_text(json.dumps(done), encoding="utf-8")
    assert run_rows(ROWS[:5], 2, tmp_path / "logs", part) == done
    assert not (tmp_path / "logs").exists()


def test_only_rows_that_were_slow_are_run_once_more() -> None:
    """A stalled machine breaks limits of time, and waits that end; no other limit."""

    def row(*runs: tuple[str, list[str]]) -> dict[str, Any]:
        entries = [{"problem": problem, "broken": broken} for problem, broken in runs]
        return {"holds": not any(run["broken"] for run in entries), "runs": entries}

    late, waited, fast = "recovered after 3 s, 2 s allowed", "no status", "rate_nm_per_s 2e3"
    judged = {
        ROWS[0].name: row(("", [])),
        ROWS[1].name: row(("", [late])),
        ROWS[2].name: row((waited, [waited, late])),
        ROWS[3].name: row(("", [late, fast])),
        ROWS[4].name: row(("", [late]), ("", ["bridge is dead"])),
    }
    assert slow_rows(ROWS[:5], judged) == [ROWS[1], ROWS[2]]


def test_rows_have_names_of_their_own_and_a_part_is_quick() -> None:
    names = [row.name for row in ROWS]
    assert len(set(names)) == len(names) > 100
    assert 20 < sum(row.quick for row in ROWS) < 40
    assert len({(row.bench, row.slug) for row in ROWS}) == len(names)
    assert len(TORQUE_LIMIT) == 7


def test_the_page_names_rows_that_do_not_hold(tmp_path: Path) -> None:
    run = {**_as_entry(), "broken": ["rate_nm_per_s 2000 above 1000"]}
    row = {"row": "some fault", "group": "process", "limits": {"hold": None}, "runs": [run]}
    path = tmp_path / "page.md"
    write_page({"rows": [row | {"holds": False}], "held": 0, "runs": 1}, path)
    text = path.read_text(encoding="utf-8")
    assert "**0 of 1 rows hold, 1 runs.**" in text
    assert "- some fault: rate_nm_per_s 2000 above 1000" in text


def test_rows_that_were_run_again_take_the_place_of_the_first_ones() -> None:
    def report(*rows: tuple[str, bool, int]) -> dict[str, Any]:
        return {"rows": [{"row": n, "holds": h, "runs": [{}] * c} for n, h, c in rows]}

    both = updated(report(("a", False, 1), ("b", True, 1)), report(("a", True, 3)))
    assert [row["row"] for row in both["rows"]] == ["a", "b"]
    assert (both["held"], both["runs"], both["again"]) == (2, 4, ["a"])


def _as_entry() -> dict[str, object]:
    entry: dict[str, object] = dict(figures(RUN, _wire(), DT, VELOCITY_LIMIT))
    return entry | {"recovery": 0.1, "dropped": 0, "refused": 0, "latched": False}
