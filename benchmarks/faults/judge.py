"""Results of a run from the monitor's recording, checked against the limits of the row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.faults.row import Limits
from benchmarks.faults.wire import Wire
from ghc_controller.types import Array

TORQUE_LIMIT = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])  # [Nm] kuka_lwr.urdf
ROUNDING = 1e-6  # [-] of a rate: stamps are whole nanoseconds
STAMPS = 0.1  # [ms] of a hold: stamps are floating-point seconds
PROBES = 5  # [-] requests of undisturbed motion before a single message
SWING = 0.8  # [s] wall of undisturbed fast motion before a fault, at least
MISSED = 0.01  # [-] of the periods: two at 200 Hz, the resolution of a window's ends
ENOUGH = 30  # [-] windows of undisturbed motion, of which a percentile is taken
TIMES = ("recovered after", "worked on after", "missed", "held after")  # how those texts begin
NO_NUMBER = 1e9  # in place of a figure that is not finite


@dataclass(frozen=True, slots=True)
class Run:
    """Data of the campaign on one run of a row; times on the monotonic clock [s]."""

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
    works_on: float | None = None  # [s] from a single message until a request is served
    undisturbed: float = 0.0  # [s] the slowest of PROBES such requests just before it


def figures(
    run: Run,
    wire: Wire,
    control_dt: float,
    velocity_limit: Array,
    torque_limit: Array = TORQUE_LIMIT,
) -> dict[str, float]:
    """Figures of the window of a run; limits in the order of the joints in its states."""
    part = wire.between(run.begin, run.end)
    values = {
        "states": len(part.stamp),
        "torque_share": part.largest_share(torque_limit),
        "rate_nm_per_s": part.largest_rate(control_dt),
        "commanded_rate_nm_per_s": part.largest_command_rate(control_dt),
        "not_finite": part.not_finite(),
        "speed_share": part.largest_share(velocity_limit, "velocity"),
        "longest_silence_ms": 1e3 * part.longest_silence(),
        "hold_after_ms": 1e3 * part.hold_after(Limits().rate * control_dt),
    }
    # A report is JSON, which has no NaN; `not_finite` says that there was one.
    return {name: value if np.isfinite(value) else NO_NUMBER for name, value in values.items()}


def missed(wire: Wire, begin: float, end: float, control_dt: float) -> float:
    """Share of the control periods between two times [s] in which no state was answered."""
    part = wire.between(begin, end)
    if len(part.stamp) < 2:
        return 1.0
    periods = max(round((part.stamp.max() - part.stamp.min()) / control_dt), 1)
    return max(1.0 - len(np.unique(part.command_stamp)) / periods, 0.0)


def usually_missed(wire: Wire, runs: Sequence[Run], control_dt: float) -> float:
    """99th percentile of `missed` over the undisturbed motion before the faults of these runs.

    It begins where the robot is driven and has served a request: what an earlier fault or a start
    of nodes has cost is not in it. 1, which nothing exceeds, with fewer than ENOUGH of them: the
    largest of a few windows is no bound for the next one on a machine that does other work.
    """
    quiet = [
        missed(wire, run.begin, run.fault, control_dt)
        for run in runs
        if run.fault - run.begin >= SWING
    ]
    return float(np.percentile(quiet, 99.0)) if len(quiet) >= ENOUGH else 1.0


def after_one(run: Run, figure: dict[str, float], limits: Limits) -> list[str]:
    """Violations after a single message; the machine may be slower than the limits.

    `figure` has the share of missed periods in the second after it, and that of undisturbed
    motion in the same campaign (99th percentile).
    """
    wrong = []
    most = max(limits.works_on, run.undisturbed)
    if run.works_on is None or run.works_on > most:
        wrong.append(f"worked on after {run.works_on} s, {most:g} s allowed")
    if figure["missed_after"] > figure["missed_undisturbed"] + MISSED:
        wrong.append(
            f"missed {100 * figure['missed_after']:.1f} % of the periods in the next second, "
            f"{100 * figure['missed_undisturbed']:.1f} % where nothing happens"
        )
    return wrong


def broken(
    run: Run, figure: dict[str, float], limits: Limits, may_latch: bool, control_dt: float
) -> list[str]:
    """Violated limits of the run; empty if there are none."""
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


def only_slow(broken_limits: Sequence[str], problem: str) -> bool:
    """Whether a run broke nothing but limits of time, as it may on a machine that stalls."""
    return all(text == problem or text.startswith(TIMES) for text in broken_limits)
