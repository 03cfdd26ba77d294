"""The network of `make hosts`, and what it writes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from benchmarks.faults.wire import Wire
from benchmarks.hosts.campaign import round_trips
from benchmarks.hosts.conditions import Conditions
from benchmarks.hosts.namespaces import UNSHARE, namespaces_work
from benchmarks.hosts.page import SECTION, write_section
from benchmarks.hosts.rows import ROWS
from benchmarks.soak.section import STACK
from benchmarks.soak.stack_page import write_stack_section

# A socket echoes on one host, another host asks 40 times; run in a namespace of its own.
_ECHO = """
import json, subprocess, sys, time
from pathlib import Path
from benchmarks.hosts.conditions import Conditions
from benchmarks.hosts.namespaces import network
SERVER = '''
import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("10.78.0.1", 5555))
print("up", flush=True)
while True:
    s.sendto(*s.recvfrom(2000))
'''
CLIENT = '''
import socket, time
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.settimeout(SECONDS)
trips = []
for k in range(COUNT):
    begun = time.monotonic()
    s.sendto(b"%d" % k * 200, ("10.78.0.1", 5555))
    try:
        s.recvfrom(2000)
        trips.append(time.monotonic() - begun)
    except TimeoutError:
        pass
print(trips)
'''
with network(("a", "b", "c"), Path(sys.argv[1])) as net:
    server = subprocess.Popen([*net.enter["a"], sys.executable, "-c", SERVER], stdout=-1)
    server.stdout.readline()
    found = {}
    for name, conditions in (
        ("plain", Conditions()), ("late", Conditions(0.02)), ("cut", Conditions(cut=True)),
    ):
        net.set(conditions)
        count, seconds = ("3", "0.2") if name == "cut" else ("10", "5.0")
        text = CLIENT.replace("COUNT", count).replace("SECONDS", seconds)
        run = subprocess.run(
            [*net.enter["c"], sys.executable, "-c", text], capture_output=True, check=True
        )
        found[name] = json.loads(run.stdout)
    server.kill()
print(json.dumps(found))
"""


def test_a_hub_between_namespaces_carries_delays_and_cuts(tmp_path: Path) -> None:
    reason = namespaces_work()
    if reason:
        pytest.skip(f"network namespaces are not allowed here: {reason}")
    path = os.pathsep.join(p or "." for p in sys.path)
    run = subprocess.run(
        [*UNSHARE, sys.executable, "-c", _ECHO, tmp_path],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stderr
    found: dict[str, list[float]] = json.loads(run.stdout)
    assert len(found["plain"]) == len(found["late"]) == 10
    assert min(found["late"]) >= 0.04  # there and back
    assert found["cut"] == []


def test_conditions_lose_and_delay_as_they_say() -> None:
    random, asked = Random(3), Conditions(0.005, 0.004, 0.1)
    lags = [asked.lag(random) for _ in range(20_000)]
    kept = np.array([lag for lag in lags if lag is not None])
    assert 1.0 - len(kept) / len(lags) == pytest.approx(0.1, abs=0.01)
    assert kept.min() >= 0.001
    assert kept.max() <= 0.009
    assert kept.mean() == pytest.approx(0.005, abs=1e-4)
    assert Conditions(cut=True).lag(random) is None
    assert Conditions.of_line(asked.line()) == asked


def test_round_trips_are_those_of_first_answers() -> None:
    stamp = np.arange(5) * 0.01
    answered, heard = np.array([0.0, 0.01, 0.01, 0.03]), np.array([0.004, 0.013, 0.018, 0.036])
    none = np.zeros((5, 7))
    wire = Wire(stamp, stamp, none, none, heard, answered, np.zeros((4, 7)))
    np.testing.assert_allclose(round_trips(wire), [0.004, 0.003, 0.006])


def _row(name: str, **changes: Any) -> dict[str, Any]:
    values: dict[str, Any] = {
        "row": name, "conditions": {"cut": "cut" in name}, "torque_share": 0.2,
        "rate_nm_per_s": 900.0, "speed_share": 0.5, "answered": 0.9, "error_mm": 1.0,
        "round_trip_ms": [1.0, 2.0, 3.0], "hold_after_ms": 20.0, "recovery": 0.1,
        "latched": False, "broken": [],
    }  # fmt: skip
    return values | changes


def test_both_sections_of_the_page_stand_beside_each_other(tmp_path: Path) -> None:
    page = tmp_path / "reliability.md"
    page.write_text("# Reliability\n\n## Not in this table\n\nrest\n", encoding="utf-8")
    rows = [_row(ROWS[0].name), _row("cut for 5 s", recovery=None, broken=["never"])]
    report = {"rows": rows, "control_dt_s": 5e-3, "load": 1.0}
    life = {"node": "recorder", "lived_s": 500.0, "last_mb": 70.0, "growth_mb_per_hour": 0.5}
    figures = {
        "simulated_s": 500.0, "wall_s": 400.0, "kills": 2, "ticks": 100, "ticks_missing": 0,
        "warm_up_s": 300.0, "lives": [life, life | {"growth_mb_per_hour": None}],
    }  # fmt: skip
    for _ in range(2):  # a second run takes the place of the first
        write_section(report, 2, page)
        write_stack_section(figures, page)
    text = page.read_text(encoding="utf-8")
    assert text.count("## Several hosts") == text.count("## The stack over a long time") == 1
    assert "| cut for 5 s | 0.20 | 900 | 0.50 |  |  | 1.0 | 20 | never |  | **no** |" in text
    assert "| `recorder` | 2 | 500 | 70.0 | 0.50 | met |" in text
    assert text.rstrip().endswith("rest")
    for section in (SECTION, STACK):
        assert section.keep("# New\n", text).count("<!--") == 2
