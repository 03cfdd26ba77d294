"""The figures of a run: errors by level, torque rate, jerk, swing, QPs and operations."""

from __future__ import annotations

import numpy as np

from benchmarks.compare.case import Result
from benchmarks.compare.runs.closed_loop import Loop, Record, Span
from benchmarks.compare.runs.probes import ramp_step, strictness
from ghc_controller.hierarchy.levels import levels
from ghc_controller.types import Array
from ghc_sim_bridge.analysis.metrics import (
    jerk_integral,
    peak_torque_rate,
    phase_end_speed,
    torque_jumps,
)

_QUARTER = 0.25  # last part of a run over which the error of the end is averaged, where it is so


def measure(loop: Loop, record: Record, last_quarter: bool = False) -> Result:
    """JSON values of a run; `end` is the last error of a span, or the mean of its last quarter."""
    settings = loop.controller.settings
    name, optimization, dt = settings.formulation, settings.optimization, settings.control_dt
    time, errors = np.array(record.time), np.array(record.errors)
    torque, jumps = np.array(record.torque), torque_jumps(np.array(record.torque))
    reached = [span for span in loop.spans if span.start <= time[-1]]
    spans = [(span.start, min(span.end, time[-1] + dt)) for span in reached]
    changing = np.array(record.changing)
    after = changing | np.roll(changing, 1)  # the step out of a change belongs to it
    strict = strictness(name, optimization, record.problems)
    return {
        "phases": [
            _levels(span, loop.controller.robot.task_names, time, errors, last_quarter)
            for span in reached
        ],
        "period_s": dt,
        "torque_rate": peak_torque_rate(time, torque, dt, spans).total,
        "torque_rate_changing": float(jumps[after].max() / dt) if changing.any() else None,
        "jerk": jerk_integral(time, np.array(record.acceleration), spans).total,
        "swing": phase_end_speed(time, np.array(record.velocity), spans).total,
        "qps": float(np.mean(record.qps)),
        "qps_changing": float(np.mean(np.array(record.qps)[changing])) if changing.any() else None,
        "pivots": float(np.mean(record.pivots)),
        "operations": float(np.mean(record.operations)),
        "steps": len(time),
        "unsolved": record.unsolved,
        "fallback": record.fallback,
        "excess_rad": max(record.excess, 0.0),
        "strict_first": strict.first,
        "strict_any": strict.any_level,
        "strict_free": strict.free,
        "ramp_step": ramp_step(name, optimization, record.changes),
        "stopped_s": record.stopped,
    }


def _levels(
    span: Span, names: tuple[str, ...], time: Array, errors: Array, last_quarter: bool
) -> Result:
    inside = np.flatnonzero((time >= span.start - 1e-9) & (time < span.end - 1e-9))
    last = inside[-max(1, round(_QUARTER * len(inside))) :] if last_quarter else inside[-1:]
    tasks = [
        {
            "level": depth,
            "task": names[task],
            "end": float(errors[last, task].mean()),
            "mean": float(errors[inside, task].mean()),
            "max": float(errors[inside, task].max()),
        }
        for depth, level in enumerate(levels(span.alpha), start=1)
        for task in level
    ]
    return {"hierarchy": span.hierarchy, "tasks": tasks}
