"""`make fuzz`: a million cases and more; ARGS="--cases N --nodes N --only words --seed S".

Ends with 1 when an undocumented error came out, or a case took more CPU or memory than it may.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.fuzz import file_targets, request_targets, wire_targets
from benchmarks.fuzz.campaign import run_target, table
from benchmarks.fuzz.node_fuzz import fuzz_nodes
from benchmarks.fuzz.target import Target
from ghc_controller.report.valid_json import json_text


def all_targets() -> tuple[Target, ...]:
    """Every target."""
    return wire_targets.targets() + request_targets.targets() + file_targets.targets()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run, print, write fuzz.json below --output."""
    parser = argparse.ArgumentParser(prog="fuzz", description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=1_000_000, help="of all targets together")
    parser.add_argument("--only", nargs="*", default=[], help="words of the names of targets")
    parser.add_argument("--nodes", type=int, default=20_000, help="messages to running nodes")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--output", type=Path, default=Path("results/fuzz"))
    options = parser.parse_args(arguments)
    chosen = [
        target
        for target in all_targets()
        if not options.only or any(word in target.name for word in options.only)
    ]
    shares = sum(target.share for target in chosen)
    outcomes = []
    for target in chosen:
        count = max(round(options.cases * target.share / shares), 1)
        outcomes.append(run_target(target, count, options.seed))
        print(table(outcomes[-1:]).splitlines()[1], file=sys.stderr, flush=True)
    print(table(outcomes))
    rows = [
        {
            "target": o.target.name, "cases": o.cases, "accepted": o.accepted,
            "slowest_ms": round(1e3 * o.slowest, 3), "budget_ms": 1e3 * o.target.budget,
            "growth_mb": round(o.growth, 2), "failures": o.failures, "holds": o.holds,
        }
        for o in outcomes
    ]  # fmt: skip
    nodes = fuzz_nodes(options.nodes, options.seed, options.output) if options.nodes else {}
    if nodes:
        print(f"nodes over DDS: {nodes}")
    options.output.mkdir(parents=True, exist_ok=True)
    path = options.output / "fuzz.json"
    path.write_text(json_text({"targets": rows, "nodes": nodes}, 1) + "\n", encoding="utf-8")
    return 0 if all(o.holds for o in outcomes) and nodes.get("holds", True) else 1


if __name__ == "__main__":
    sys.exit(main())
