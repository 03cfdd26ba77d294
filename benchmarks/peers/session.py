"""All sides on all cases, in turn: `make bench ARGS="--only peers"`."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.machine import load_average, machine_facts
from benchmarks.peers.environment import peer_python
from benchmarks.peers.problem import PeerProblem
from benchmarks.peers.process import SideProcess
from benchmarks.peers.report import peers_table, plot_peers, write_page
from ghc_controller.report.valid_json import json_text
from tools.workspace.layout import Layout

STATES = Path(__file__).resolve().parent / "states"
PEERS = ("tsid", "placo")
FILE = "peers.json"
_FORMULATIONS = ("cascade", "balanced", "ghc")
_RAMPS = ("kuka_lwr_5_free", "icub_5_free")  # also with two active orders
_ROUNDS, _QUICK_ROUNDS = 20, 1


@dataclass(frozen=True, slots=True)
class Entry:
    """One side of one case."""

    side: str  # process
    title: str  # "cascade", "tsid", ...
    options: tuple[str, ...] = ()


def run_peers(root: Path, output: Path, *, quick: bool, write_docs: bool) -> list[dict[str, Any]]:
    """Measure, print, write `peers.json` and a plot below `output`; the rows."""
    layout = Layout(root)
    files = sorted(STATES.glob("*.npz"))
    before = load_average()
    with ExitStack() as stack:
        sides = {"ours": SideProcess("ours", Path(sys.executable), root, foreign=False)}
        for peer in PEERS:
            sides[peer] = SideProcess(peer, peer_python(peer, layout), root, foreign=True)
        for process in sides.values():
            stack.enter_context(process)
        rounds = _QUICK_ROUNDS if quick else _ROUNDS
        rows = [row for file in files for row in _case(file, sides, rounds)]
    results = {
        "machine": machine_facts(),
        "load_average": {"before": before, "after": load_average()},
        "peers": {peer: _version(peer, layout) for peer in PEERS},
        "rounds": rounds,
        "rows": rows,
    }
    output.mkdir(parents=True, exist_ok=True)
    (output / FILE).write_text(json_text(results, 1) + "\n", encoding="utf-8")
    plot_peers(rows, output / "peers.png")
    print(peers_table(rows))
    if write_docs:
        write_page(results, root / "docs")
    print(f"\nwritten: {output / FILE}", file=sys.stderr)
    return rows


def _version(peer: str, layout: Layout) -> str:
    """The version that a peer's lock asks for."""
    text = layout.peer_lock(peer, sys.version_info[:2]).read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith(f"{peer}=="))
    return line.removeprefix(f"{peer}==").split()[0]


def _case(file: Path, sides: Mapping[str, SideProcess], rounds: int) -> list[dict[str, Any]]:
    """Rows of one case: in strict order, and in a ramp if requested."""
    print(f"bench: {file.stem}", file=sys.stderr, flush=True)
    problem = PeerProblem.load(file)
    orders = ("strict", "ramp") if file.stem in _RAMPS else ("strict",)
    rows = []
    for order in orders:
        entries = [Entry("ours", name, (name, order)) for name in _FORMULATIONS]
        entries += [Entry(peer, peer) for peer in PEERS]
        facts = {entry.title: _opened(entry, order, file, sides) for entry in entries}
        times = _measured(entries, order, file.stem, sides, rounds)
        rows.append(
            {
                "case": file.stem if order == "strict" else f"{file.stem}_{order}",
                "robot": problem.robot,
                "tasks": len(problem.tasks),
                "bounded": problem.bounded,
                "order": order,
                **{title: {**times[title], **facts[title]} for title in facts},
            }
        )
    return rows


def _opened(
    entry: Entry, order: str, file: Path, sides: Mapping[str, SideProcess]
) -> dict[str, Any]:
    """Prepare a case; returns the number of failed steps, and means of the project's counts."""
    facts = sides[entry.side].open(_name(entry, order, file.stem), file, entry.options)
    torques = facts.pop("torques")
    missing = sum(torque is None for torque in torques) / len(torques)
    return {"no_answer_share": missing, **facts}


def _measured(
    entries: Sequence[Entry],
    order: str,
    case: str,
    sides: Mapping[str, SideProcess],
    rounds: int,
) -> dict[str, dict[str, float]]:
    """Percentiles [us]; in every round all sides in random order."""
    rng = np.random.default_rng(0)
    wall: dict[str, list[int]] = {entry.title: [] for entry in entries}
    cpu: dict[str, list[int]] = {entry.title: [] for entry in entries}
    for _ in range(rounds):
        for index in rng.permutation(len(entries)):
            entry = entries[index]
            answer = sides[entry.side].run(_name(entry, order, case))
            wall[entry.title] += answer["wall_ns"]
            cpu[entry.title] += answer["cpu_ns"]
    return {
        entry.title: {
            **_percentiles(wall[entry.title], ""),
            **_percentiles(cpu[entry.title], "cpu_"),
        }
        for entry in entries
    }


def _percentiles(nanoseconds: Sequence[int], prefix: str) -> dict[str, float]:
    values = np.percentile(np.array(nanoseconds) * 1e-3, [50.0, 99.0, 99.9])
    names = ("p50_us", "p99_us", "p99.9_us")
    return {
        prefix + name: round(float(value), 2) for name, value in zip(names, values, strict=True)
    }


def _name(entry: Entry, order: str, case: str) -> str:
    return f"{case}_{entry.title}_{order}"
