"""Figures of a run from what the monitor saw, and whether they keep the limits of the row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.faults.row import Limits
from benchmarks.faults.wire import Wire
from ghc_controller.types import Array

TORQUE_LIMIT = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])  # [Nm] kuka_lwr.urdf
ROUNDING = 1e-6  # [-] of a rate: stamps are whole nanoseconds
STAMPS = 0.1  # [ms] of a hold: stamps are floating-point seconds
NO_NUMBER = 1e9  # in place of a figure that is not finite


@dataclass(frozen=True, slots=True)
class Run:
    """What the campaign knows of one run of a row; times on the monotonic clock [s]."""

    row: str
    seed: int
    begin: float
    fault: float
    end: float
    recovery: float | None  # [s] None = not within the patience
    latched: bool
    dead: tuple[str, ...]  # nodes that ended and should not have
    dropped: int  # periods that the bridge was too late for, by the machine
    refused: int = 0  # messages that the nodes counted as rejected: what reached them
    problem: str = ""  # an injection that failed


def figures(run: Run, wire: Wire, control_dt: float, velocity_limit: Array) -> dict[str, float]:
    """Figures of the window of a run."""
    part = wire.between(run.begin, run.end)
    values = {
        "states": len(part.stamp),
        "torque_share": part.largest_share(TORQUE_LIMIT),
        "rate_nm_per_s": part.largest_rate(control_dt),
        "commanded_rate_nm_per_s": part.largest_command_rate(control_dt),
        "not_finite": part.not_finite(),
        "speed_share": part.largest_share(velocity_limit, "velocity"),
        "longest_silence_ms": 1e3 * part.longest_silence(),
        "hold_after_ms": 1e3 * part.hold_after(),
    }
    # A report is JSON, which has no NaN; `not_finite` says that there was one.
    return {name: value if np.isfinite(value) else NO_NUMBER for name, value in values.items()}


def broken(
    run: Run, figure: dict[str, float], limits: Limits, may_latch: bool, control_dt: float
) -> list[str]:
    """What the run did not keep; empty when it holds."""
    wrong = [f"{name} is dead" for name in run.dead]
    if run.problem:
        wrong.append(run.problem)
    if figure["not_finite"]:
        wrong.append("a number that is not finite")
    for name, most in (
        ("torque_share", limits.torque),
        ("rate_nm_per_s", limits.rate),
        ("speed_share", limits.speed),
    ):
        if figure[name] > most * (1.0 + ROUNDING):
            wrong.append(f"{name} {figure[name]:g} above {most:g}")
    if run.recovery is None or run.recovery > limits.recovery:
        wrong.append(f"recovered after {run.recovery} s, {limits.recovery:g} s allowed")
    if run.latched and not may_latch:
        wrong.append("latched")
    if limits.hold is not None:
        # One period until it is looked at, one until the state with it is published.
        most = 1e3 * (limits.hold + 2.0 * control_dt) + STAMPS
        if figure["hold_after_ms"] > most:
            wrong.append(f"held after {figure['hold_after_ms']:.1f} ms")
    return wrong
