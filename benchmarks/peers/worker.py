"""One side in a separate process: requests and replies are lines of JSON.

`python -m benchmarks.peers.worker SIDE`: {"open": file, "urdf": file, "options": [], "as": name}
prepares a case, {"run": name} times one step at each of its states.
"""

from __future__ import annotations

import json
import sys
from importlib import import_module
from pathlib import Path
from time import perf_counter_ns, thread_time_ns
from typing import Any, Protocol

from benchmarks.peers.problem import Array, PeerProblem

SIDES = {
    "ours": ("benchmarks.peers.own_side", "OwnSide"),
    "tsid": ("benchmarks.peers.tsid_side", "TsidSide"),
    "placo": ("benchmarks.peers.placo_side", "PlacoSide"),
}


class Side(Protocol):
    """A controller of one case."""

    def enter(self, row: int) -> None:
        """Set the goals of the segment that begins with a state."""

    def step(self, row: int) -> Array | None:
        """Torque (a,) [Nm] at a state, model update included; None without an answer."""


def main() -> None:
    """Serve requests until the input ends."""
    module, name = SIDES[sys.argv[1]]
    kind = getattr(import_module(module), name)
    cases: dict[str, tuple[PeerProblem, Side]] = {}
    for line in sys.stdin:
        request: dict[str, Any] = json.loads(line)
        if "open" in request:
            problem = PeerProblem.load(Path(request["open"]))
            side = kind(problem, request["urdf"], *request["options"])
            cases[request["as"]] = (problem, side)
            answer = _watched(problem, side)
        else:
            answer = dict(timed_once(*cases[request["run"]]))
        print(json.dumps(answer), flush=True)


def _watched(problem: PeerProblem, side: Side) -> dict[str, Any]:
    """Every state once, without timing: torques, and facts reported by the side."""
    answers = []
    step = getattr(side, "watch", side.step)
    for row in range(len(problem.q)):
        if problem.begins(row):
            side.enter(row)
        answers.append(step(row))
    facts: dict[str, Any] = getattr(side, "facts", dict)()
    torques = [None if torque is None else torque.tolist() for torque in answers]
    return {"torques": torques, **facts}


def timed_once(problem: PeerProblem, side: Side) -> dict[str, list[int]]:
    """Times [ns] of one step at each state: `wall_ns` and `cpu_ns`."""
    wall, cpu = [], []
    for row in range(len(problem.q)):
        if problem.begins(row):
            side.enter(row)
        cpu_start, start = thread_time_ns(), perf_counter_ns()
        side.step(row)
        wall.append(perf_counter_ns() - start)
        cpu.append(thread_time_ns() - cpu_start)
    return {"wall_ns": wall, "cpu_ns": cpu}


if __name__ == "__main__":
    main()
