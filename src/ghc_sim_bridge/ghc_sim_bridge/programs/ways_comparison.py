"""Compares strategies to release a contact: ways.json, a table, a figure.

Raw bounds, bounds from a generator, and other variants of a scenario, such as a force task that
fades in (thesis, figures 5.15 and 5.16).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ghc_controller.errors import UnknownName
from ghc_sim_bridge.analysis.analysis import analyse_folder
from ghc_sim_bridge.analysis.generator_analysis import (
    CONSTRAINTS,
    GeneratorAnalysis,
    analyse_generators,
)
from ghc_sim_bridge.analysis.summary import rounded, write_json
from ghc_sim_bridge.analysis.text_table import aligned
from ghc_sim_bridge.figures.style import save_png
from ghc_sim_bridge.figures.ways import ways_figure
from ghc_sim_bridge.logs.constraint_series import ConstraintSeries
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scenario.plan import RunPlan

WAYS = "ways"


@dataclass(frozen=True, slots=True)
class TorqueRates:
    """Largest |dtau/dt| of some joints [Nm/s], at the control period of the run."""

    run: float  # over the whole run
    events: tuple[float, ...]  # in the window around each event


def joint_rates(
    log: FullRateLog, joints: Sequence[str], windows: Sequence[tuple[float, float]]
) -> TorqueRates:
    """Peaks of the named joints; UnknownName for joints missing in the log."""
    for name in joints:
        if name not in log.joint_names:
            raise UnknownName("watched joint", name, log.joint_names)
    columns = [log.joint_names.index(name) for name in joints]
    steps = np.abs(np.diff(log.torque[:, columns], axis=0)).max(axis=1) / log.control_dt
    times = log.time[1:]
    peaks = [steps[(times >= start) & (times <= end)].max(initial=0.0) for start, end in windows]
    return TorqueRates(float(steps.max(initial=0.0)), tuple(float(peak) for peak in peaks))


def way_name(plan: RunPlan) -> str:
    """Label of a strategy: its variant, or raw or smoothed bounds."""
    if plan.scenario.raw_bounds_only:
        return plan.scenario.variant.replace("_", " ")
    return "raw bounds" if plan.options.generators is False else "smoothed bounds"


def ways_data(ways: Mapping[str, GeneratorAnalysis]) -> dict[str, Any]:
    """Results of every strategy, for the watched joints and for all joints."""
    first = next(iter(ways.values())).analysis.plan
    scenario = first.scenario
    data: dict[str, Any] = {
        "scenario": scenario.name,
        "formulation": first.formulation,
        "control_dt_s": first.control_dt,
        "watched_joints": list(scenario.watched_joints),
        "events": [{"name": e.name, "time_s": e.time} for e in scenario.events],
        "ways": {},
    }
    for name, run in ways.items():
        log = run.analysis.log
        watched = joint_rates(log, scenario.watched_joints, run.windows)
        data["ways"][name] = {
            "folder": run.analysis.plan.folder.name,
            "watched_peak_nm_per_s": {"run": watched.run, "events": list(watched.events)},
            "peak_nm_per_s": {"run": run.analysis.torque_rate.total, "events": list(run.peaks)},
        }
    return data


def ways_table(data: Mapping[str, Any]) -> str:
    """The strategies as text, one per line."""
    period = 1e3 * data["control_dt_s"]
    head = [f"largest torque rate [Nm/s @ {period:g} ms]", *_columns(data)]
    rows = []
    for name, way in data["ways"].items():
        figures = []
        for key in ("watched_peak_nm_per_s", "peak_nm_per_s"):
            figures += [*way[key]["events"], way[key]["run"]]
        rows.append([name, *(f"{value:.4g}" for value in figures)])
    return aligned(head, rows, left=(0,))


def _columns(data: Mapping[str, Any]) -> list[str]:
    whose = (", ".join(data["watched_joints"]), "any joint")
    when = [*(event["name"] for event in data["events"]), "whole run"]
    return [f"{who}, {what}" for who in whose for what in when]


def compare_ways(plans: Sequence[RunPlan]) -> dict[str, Any]:
    """Write ways.json and ways.png of finished runs, print the table."""
    ways = {way_name(plan): _from_folder(plan) for plan in plans}
    data = rounded(ways_data(ways))
    folder = _folder(plans)
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / f"{WAYS}.json", data)
    save_png(ways_figure(ways), folder / f"{WAYS}.png")
    print(f"\n{plans[0].scenario.title}: all ways\n{ways_table(data)}")
    print(f"all ways: {folder / f'{WAYS}.json'}, {WAYS}.png", flush=True)
    return dict(data)


def _folder(plans: Sequence[RunPlan]) -> Path:
    """Folder next to the runs, or a separate one if options differ from the scenario."""
    if any(plan.is_default for plan in plans):
        return plans[0].folder.parent
    name = plans[0].folder.name.replace("generators_off", WAYS).replace("generators_on", WAYS)
    return plans[0].folder.with_name(name)


def _from_folder(plan: RunPlan) -> GeneratorAnalysis:
    series = ConstraintSeries.load(plan.folder / CONSTRAINTS)
    return analyse_generators(analyse_folder(plan), series)
