"""`make bench ARGS="--only tails"`: the slowest of 1e5 control steps at the recorded states.

By the clock, and by the thread's processor time, which other work lengthens little.
"""

from __future__ import annotations

import gc
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.machine import load_average, machine_facts
from benchmarks.peers.own_side import OwnSide
from benchmarks.peers.problem import PeerProblem
from benchmarks.peers.worker import timed_once
from ghc_controller.report.valid_json import json_text

CASES = ("kuka_lwr_5_free", "kuka_lwr_5_bounds", "icub_7_free", "icub_7_bounds", "icub_standing_5")
STEPS, QUICK_STEPS = 100_000, 500  # [-] of a case, at least
LONG_US = 1000.0  # [us] a step that is counted


def run_tails(root: Path, output: Path, *, quick: bool) -> dict[str, Any]:
    """Measure, print, write `tails.json`; its content."""
    rows = []
    for name in CASES:
        print(f"bench: {name}", file=sys.stderr, flush=True)
        problem = PeerProblem.load(root / "benchmarks" / "peers" / "states" / f"{name}.npz")
        rows.append({"case": name} | _tails(problem, QUICK_STEPS if quick else STEPS))
        print(json.dumps(rows[-1]), flush=True)
    results = {"machine": machine_facts(), "load_average": load_average(), "rows": rows}
    output.mkdir(parents=True, exist_ok=True)
    (output / "tails.json").write_text(json_text(results, 1) + "\n", encoding="utf-8")
    return results


def _tails(problem: PeerProblem, steps: int) -> dict[str, float]:
    side = OwnSide(problem, "", "cascade", "strict")
    wall: list[int] = []
    cpu: list[int] = []
    gc.collect()
    while len(cpu) < steps:
        times = timed_once(problem, side)
        wall += times["wall_ns"]
        cpu += times["cpu_ns"]
    found: dict[str, float] = {"steps": len(cpu)}
    for kind, values in (("cpu", cpu), ("wall", wall)):
        us = np.array(values) / 1e3
        for percent in (50.0, 99.0, 99.9, 99.99):
            found[f"{kind}_p{percent:g}_us"] = round(float(np.percentile(us, percent)), 1)
        found[f"{kind}_largest_us"] = round(float(us.max()), 1)
        found[f"{kind}_above_1_ms"] = int((us > LONG_US).sum())
    return found
