"""summary.json: the figures of one run under stable names, with units in the names."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.analysis.balance_summary import balance_summary
from ghc_sim_bridge.analysis.claims import error_disagreement
from ghc_sim_bridge.analysis.metrics import PhasedFigure, percentiles
from ghc_sim_bridge.analysis.rest import rest_summary
from ghc_sim_bridge.logs.controller_trace import ControllerTrace
from ghc_sim_bridge.logs.full_rate_log import Source

_DIGITS = 9  # significant digits of every number


def make_summary(
    analysis: Analysis,
    trace: ControllerTrace,
    exit_codes: Mapping[str, int | None],
    wall_seconds: float,
) -> dict[str, Any]:
    """The summary of a run; numbers have few digits, and null stands for none."""
    plan, log = analysis.plan, analysis.log
    sim_seconds = len(log.time) * log.control_dt
    rate_limit = analysis.limits.torque_rate
    summary = {
        "scenario": plan.scenario.name,
        "title": plan.scenario.title,
        "variant": plan.folder.name,
        "robot": analysis.robot.name,
        "formulation": plan.formulation,
        "mode": plan.options.mode,
        "control_dt_s": log.control_dt,
        "transition_s": plan.transition,
        "transition_torque_rate_nm_per_s": plan.torque_rate if plan.torque_rate > 0.0 else None,
        "sim_seconds": sim_seconds,
        "wall_seconds": wall_seconds,
        "real_time_factor": sim_seconds / wall_seconds,
        "nodes": dict(exit_codes),
        "phases": _phases(analysis),
        "error_units": {task.name: task.unit for task in analysis.history.tasks},
        "peak_torque_rate_nm_per_s": _phased(analysis.torque_rate),
        "peak_torque_jump_nm": _phased(analysis.torque_jump),
        "start_up_torque_jump_nm": analysis.start_up_jump,
        "jerk_integral": _phased(analysis.jerk),
        "jerk_integral_unit": "rad/s^2",
        "phase_end_speed_rad_per_s": _phased(analysis.end_speed),
        "rest": rest_summary(analysis.rest),
        "limit_violations": dict(analysis.violations),
        "limit_violations_unit": "largest excess as a fraction of the limit",
        "soft_row_slack": trace.slack,
        "solve_time_us": percentiles(trace.time_solve),
        "step_time_us": percentiles(trace.time_step),
        "terms_time_us": percentiles(trace.time_terms),
        "cycle_time_us": percentiles(log.cycle_time[1:].tolist()),
        "timing_samples": len(trace.time_step),
        "qp_failures": trace.counts.get("qp_failures"),
        "fallback_ticks": trace.counts.get("fallback_ticks"),
        "fallback_reasons": sorted(trace.fallback_reasons),
        "counts": trace.counts,
        "controller_error_disagreement": error_disagreement(analysis.history, trace),
        "gated_ticks": int((log.source == Source.GATED).sum()),
        "held_ticks": int((log.source == Source.HOLD).sum()),
        "torque_rate_limit_nm_per_s": rate_limit if rate_limit > 0.0 else None,
    }
    summary |= _contact_forces(analysis)
    summary |= balance_summary(analysis, trace)
    if plan.scenario.paper:
        summary["paper"] = _beside_paper(analysis)
    return rounded(summary)


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Write JSON so that a reader sees either the whole file or none of it."""
    draft = path.with_name(f".{path.name}.draft")
    draft.write_text(json.dumps(data, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    draft.replace(path)


def rounded(value: Any) -> Any:
    """The same data with numbers of limited digits, and null for what is not finite."""
    if isinstance(value, Mapping):
        return {str(key): rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None
    return int(value) if isinstance(value, np.integer) else value


def _phases(analysis: Analysis) -> list[dict[str, Any]]:
    return [
        {
            "hierarchy": planned.phase.hierarchy,
            "t_start": planned.start,
            "t_end": planned.end,
            "transition_s": planned.ramp,
            "errors": dict(errors),
        }
        for planned, errors in zip(analysis.plan.phases, analysis.phase_errors, strict=True)
    ]


def _phased(figure: PhasedFigure) -> dict[str, Any]:
    return {"total": figure.total, "per_phase": list(figure.per_phase)}


def _contact_forces(analysis: Analysis) -> dict[str, Any]:
    """Desired and measured force at the end of each phase, of tasks that have one."""
    history, forces = analysis.history, {}
    ends = [
        int(np.searchsorted(history.time, planned.end - 1e-9)) - 1
        for planned in analysis.plan.phases
    ]
    for task in history.tasks:
        if task.desired_force is not None and task.measured_force is not None:
            forces[task.name] = [
                {
                    "desired_n": task.desired_force[k].tolist(),
                    "measured_n": task.measured_force[k].tolist(),
                }
                for k in ends
            ]
    return {"contact_force": forces} if forces else {}


def _beside_paper(analysis: Analysis) -> dict[str, Any]:
    """The scenario's words on the paper, and its figures of each phase beside ours."""
    phases = [
        {
            "hierarchy": planned.phase.hierarchy,
            "paper": dict(planned.phase.paper),
            "ours": dict(errors),
        }
        for planned, errors in zip(analysis.plan.phases, analysis.phase_errors, strict=True)
        if planned.phase.paper
    ]
    content = dict(analysis.plan.scenario.paper)
    return content | ({"phase_errors": phases} if phases else {})
