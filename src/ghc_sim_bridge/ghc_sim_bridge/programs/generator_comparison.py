"""Compares runs with raw and smoothed bounds: comparison.json, a table, a figure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ghc_controller.previews.preview import BODY_MARGINS
from ghc_sim_bridge.analysis.analysis import analyse_folder
from ghc_sim_bridge.analysis.generator_analysis import (
    CONSTRAINTS,
    GeneratorAnalysis,
    analyse_generators,
)
from ghc_sim_bridge.analysis.generator_metrics import ratios
from ghc_sim_bridge.analysis.summary import rounded, write_json
from ghc_sim_bridge.analysis.text_table import aligned
from ghc_sim_bridge.figures.generators import generator_figure
from ghc_sim_bridge.figures.style import save_png
from ghc_sim_bridge.logs.constraint_series import ConstraintSeries
from ghc_sim_bridge.scenario.plan import RunPlan

COMPARISON = "comparison.json"
FIGURE = "generators.png"
Summary = Mapping[str, Any]


def comparison(
    off: GeneratorAnalysis, on: GeneratorAnalysis, summaries: tuple[Summary, Summary]
) -> dict[str, Any]:
    """Comparison of both runs; `summaries` and runs without generators first."""
    plan = on.analysis.plan
    pairs = zip(off.peaks, on.peaks, strict=True)
    times = ratios(off.peaks, on.peaks)
    events = [
        {
            "name": event.name,
            "time_s": event.time,
            "window_s": list(window),
            "peak_torque_rate_nm_per_s": {"off": without, "on": smoothed},
            "ratio": ratio,
        }
        for event, window, (without, smoothed), ratio in zip(
            plan.scenario.events, on.windows, pairs, times, strict=True
        )
    ]
    sides = {"off": summaries[0], "on": summaries[1]}
    bounds = {"off": off.summary(), "on": on.summary()}
    return rounded(
        {
            "scenario": plan.scenario.name,
            "formulation": plan.formulation,
            "control_dt_s": plan.control_dt,
            "variants": {"off": off.analysis.plan.folder.name, "on": plan.folder.name},
            "events": events,
            "smallest_ratio": min(times, default=None),
            "contacts": {
                name: {side: bounds[side]["contacts"].get(name) for side in sides}
                for name in on.following
            },
            "obstacles": {
                name: {side: bounds[side]["obstacles"].get(name) for side in sides}
                for name in on.distances
            },
            "limits": {
                name: {side: bounds[side]["limits"].get(name) for side in sides}
                for name in on.limits
            },
            **{
                figure: {side: summary[figure] for side, summary in sides.items()}
                for figure in (
                    "real_time_factor",
                    "limit_violations",
                    "qp_failures",
                    "fallback_ticks",
                    "torque_rate_limit_nm_per_s",
                )
            },
        }
    )


def comparison_table(data: Mapping[str, Any]) -> str:
    """The events of a comparison and its bound violations as text."""
    period = 1e3 * data["control_dt_s"]
    head = ["event", "at [s]", f"torque rate off [Nm/s @ {period:g} ms]", "on", "ratio"]
    rows = [
        [
            event["name"],
            f"{event['time_s']:g}",
            *(f"{event['peak_torque_rate_nm_per_s'][side]:.4g}" for side in ("off", "on")),
            "–" if event["ratio"] is None else f"{event['ratio']:.1f}",
        ]
        for event in data["events"]
    ]
    lines = [aligned(head, rows, left=(0,))]
    for name, sides in data["contacts"].items():
        lines += [f"contact {name}, generators {side}: {_force(v)}" for side, v in sides.items()]
    for name, sides in data["obstacles"].items():
        lines += [f"obstacle {name}, generators {side}: {_way(v)}" for side, v in sides.items()]
    for name, sides in data["limits"].items():
        text = _margin if name.startswith(f"{BODY_MARGINS}/") else _limit
        lines += [f"{name}, generators {side}: {text(v)}" for side, v in sides.items()]
    factors = data["real_time_factor"]
    lines.append(f"real time factor: off {factors['off']:.2f}, on {factors['on']:.2f}")
    return "\n".join(lines)


def compare_generators(off: RunPlan, on: RunPlan, summaries: Sequence[Summary]) -> dict[str, Any]:
    """Write comparison and figure of two finished runs, print the table."""
    analyses = [_from_folder(plan) for plan in (off, on)]
    data = comparison(analyses[0], analyses[1], (summaries[0], summaries[1]))
    folder = comparison_folder(on)
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / COMPARISON, data)
    save_png(generator_figure(analyses[0], analyses[1]), folder / FIGURE)
    print(f"\n{on.scenario.title}: without and with smoothed bounds")
    print(comparison_table(data))
    print(f"comparison: {folder / COMPARISON}", flush=True)
    return data


def comparison_folder(on: RunPlan) -> Path:
    """Folder of the comparison: next to the default variant, else a separate one."""
    if on.is_default:
        return on.folder.parent
    return on.folder.with_name(on.folder.name.replace("generators_on", "generators_both"))


def _from_folder(plan: RunPlan) -> GeneratorAnalysis:
    series = ConstraintSeries.load(plan.folder / CONSTRAINTS)
    return analyse_generators(analyse_folder(plan), series)


def _force(values: Mapping[str, float] | None) -> str:
    if values is None:
        return "no bounds"
    return (
        f"QP beyond its bounds by at most {values['qp_violation']:.1e} N; "
        "simulated against commanded "
        f"{values['difference_rms']:.2g} N rms, at most {values['difference_largest']:.2g} N; "
        f"simulated above the bound by at most {values['above_upper']:.2g} N"
    )


def _way(values: Mapping[str, float] | None) -> str:
    if values is None:
        return "never seen"
    return (
        f"eq. 4.2 missed by at most {values['qp_violation_m']:.1e} m; inside the safe "
        f"distance of the obstacle itself for {values['inside_safe_distance_s']:.2g} s"
    )


def _limit(values: Mapping[str, float] | None) -> str:
    if values is None:
        return "never followed"
    return (
        f"limit looser than raw by at most {values['looser_than_raw']:.1e}; joint beyond the raw "
        f"limit by at most {values['beyond_raw']:.1e}"
    )


def _margin(values: Mapping[str, float] | None) -> str:
    if values is None:
        return "never followed"
    return (
        f"distance below the margin in force by at most {values['beyond_in_force']:.1e} m, below "
        f"the raw one by {values['beyond_raw']:.1e} m"
    )
