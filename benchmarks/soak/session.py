"""One soak: drive both generators, sample their memory, print, write."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import rclpy
from rclpy.context import Context

import ghc_controller as ghc
from benchmarks.soak.driver import STEP_NS, Driver
from benchmarks.soak.inputs import DRIVERS
from benchmarks.soak.memory import MemoryCourse, resident_memory
from benchmarks.soak.report import FIGURE, plot_memory, soak_table, write_soak_section
from ghc_controller.report.valid_json import json_text
from ghc_sim_bridge.run.domain import DomainLock
from ghc_sim_bridge.run.processes import NodeProcesses

_PACKAGE = "ghc_mpc_constraints"
_TELL_EVERY = 60.0  # [s] simulated


@dataclass(frozen=True, slots=True)
class SoakTimes:
    """All in simulated time [s]."""

    length: float
    warm_up: float  # what the memory does before does not count
    sample: float  # between two looks at it


FULL = SoakTimes(length=600.0, warm_up=60.0, sample=1.0)
QUICK = SoakTimes(length=3.0, warm_up=1.0, sample=0.1)


def run_soak(options: argparse.Namespace, root: Path) -> bool:
    """Drive both nodes one after the other; True when the memory of both stays.

    Raises:
        GhcError: a node ended, or did not answer.
    """
    times = QUICK if options.quick else FULL
    options.output.mkdir(parents=True, exist_ok=True)
    courses = [_course(driver, options.output, times) for driver in DRIVERS]
    rows = [course.summary() for course in courses]
    results: dict[str, Any] = {
        "quick": options.quick,
        "nodes": rows,
        "courses": {c.node: {"time_s": c.times, "resident_mb": c.resident} for c in courses},
    }
    print(soak_table(rows))
    path = options.output / "soak.json"
    path.write_text(json_text(results, 1) + "\n", encoding="utf-8")
    plot_memory(courses, options.output / FIGURE)
    if options.write_docs:
        plot_memory(courses, root / "docs" / "figures" / FIGURE)
        write_soak_section(results, root / "docs" / "benchmarks.md")
    print(f"\nwritten: {path}", file=sys.stderr)
    return all(row["met"] for row in rows)


def _course(kind: type[Driver], folder: Path, times: SoakTimes) -> MemoryCourse:
    domain = DomainLock()
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ["ROS_LOG_DIR"] = str(folder)
    environment = os.environ | {"ROS_DOMAIN_ID": str(domain.id)}
    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain.id)
    driver = kind(context)
    try:
        with NodeProcesses(folder, environment) as nodes:
            nodes.start(kind.generator, _PACKAGE, kind.generator, [])
            return _drive(driver, nodes.pid_of(kind.generator), times, nodes.check)
    finally:
        driver.close()
        rclpy.shutdown(context=context)
        domain.release()


def _drive(driver: Driver, pid: int, times: SoakTimes, check: Callable[[], None]) -> MemoryCourse:
    """Tick after tick; `check` raises when the node has ended."""
    period = STEP_NS * 1e-9
    every, tell_every = round(times.sample / period), round(_TELL_EVERY / period)
    moments: list[float] = []
    resident: list[float] = []
    handled = 0
    begun = time.monotonic()
    for number in range(round(times.length / period) + 1):
        driver.tick(number, check)
        handled = max(handled, driver.handled)
        if number % every == 0:
            moments.append(round(number * period, 6))
            resident.append(round(resident_memory(pid), 4))
        if number % tell_every == 0:
            factor = number * period / (time.monotonic() - begun)
            told = f"{number * period:.0f} of {times.length:g} s simulated"
            print(f"soak: {driver.generator}, {told} ({factor:.1f} x)", file=sys.stderr)
    if not handled:
        raise ghc.GhcError(f"{driver.generator}: no plan held anything")
    return MemoryCourse(
        driver.generator, tuple(moments), tuple(resident), times.warm_up, driver.plans, handled
    )
