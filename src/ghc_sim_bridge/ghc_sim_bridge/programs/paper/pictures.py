"""Figures for docs/results.md: copies of figures of the runs, and comparisons."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from ghc_sim_bridge.analysis.analysis import analyse_folder
from ghc_sim_bridge.figures.comparison import (
    Summary,
    jerk_comparison,
    rate_comparison,
    torque_comparison,
    variants_comparison,
)
from ghc_sim_bridge.figures.style import save_png
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.programs.generator_comparison import FIGURE, comparison_folder
from ghc_sim_bridge.programs.paper.runs import GENERATOR_PAIRS, beside
from ghc_sim_bridge.scenario.plan import RunPlan

SWITCHING_RUNS = {
    "hqp": "hqp, at once",
    "hqp_braked": "hqp, at once,\ndamped to -kd v",
    "ghc_fast": "ghc, 0.005 s",
    "cascade_fast": "cascade, 0.005 s",
    "ghc": "ghc, 2 s",
    "balanced": "balanced, 2 s",
    "cascade": "cascade, 2 s",
}
_SIDE_BY_SIDE = ("hqp", "cascade")  # torques of the first switch
NONSTRICT_RUNS = {"nonstrict_0.2": 0.2, "nonstrict_0.5": 0.5, "nonstrict_0.8": 0.8}
_IN_BOTH = {
    "insertion_removal": (("tasks", "insertion_removal_tasks"),),
    "lemniscate": (
        ("tasks", "lemniscate_tasks"),
        ("path_end_effector", "lemniscate_path"),
        ("joints", "lemniscate_joints"),
    ),
    "contact_force": (("force_end_effector", "contact_force"),),
}
# run -> (figure of the run, name in the documentation)
_COPIES = {
    "hqp": (("tasks", "switching_hqp_tasks"),),
    "ghc_fast": (("tasks", "switching_ghc_fast_tasks"),),
    "ghc": (("tasks", "switching_ghc_tasks"),),
    "cascade_fast": (("tasks", "switching_cascade_fast_tasks"),),
    "cascade": (("tasks", "switching_cascade_tasks"),),
    **_IN_BOTH,
    **{
        beside(name): tuple((stem, beside(target)) for stem, target in copies)
        for name, copies in _IN_BOTH.items()
    },
}


class Result(Protocol):
    """The required interface of a finished run."""

    @property
    def plan(self) -> RunPlan:
        """Its plan, which includes its folder."""

    @property
    def summary(self) -> Summary:
        """Content of its summary.json."""


def write_pictures(results: Mapping[str, Result], folder: Path) -> frozenset[str]:
    """Write all figures for the available results; returns their file names."""
    folder.mkdir(parents=True, exist_ok=True)
    written = set()
    for name, copies in _COPIES.items():
        for stem, target in copies:
            source = results[name].plan.folder / f"{stem}.png" if name in results else None
            if source is not None and source.is_file():
                shutil.copyfile(source, folder / f"{target}.png")
                written.add(f"{target}.png")
    for name in GENERATOR_PAIRS:
        source = comparison_folder(results[name].plan) / FIGURE if name in results else None
        if source is not None and source.is_file():
            shutil.copyfile(source, folder / f"{name}.png")
            written.add(f"{name}.png")
    present = [name for name in SWITCHING_RUNS if name in results]
    if present:
        logs = {
            SWITCHING_RUNS[name]: (results[name].summary, FullRateLog.load(_log(results[name])))
            for name in present
        }
        save_png(jerk_comparison(logs), folder / "switching_jerk.png")
        rates = {label: summary for label, (summary, _) in logs.items()}
        if "hqp_gated" in results:
            rates["hqp, rate limit on"] = results["hqp_gated"].summary
        save_png(rate_comparison(rates), folder / "switching_rates.png")
        written |= {"switching_jerk.png", "switching_rates.png"}
        if all(name in present for name in _SIDE_BY_SIDE):
            pair = {SWITCHING_RUNS[name]: logs[SWITCHING_RUNS[name]] for name in _SIDE_BY_SIDE}
            save_png(torque_comparison(pair), folder / "switching_torques.png")
            written.add("switching_torques.png")
    for picture, named in (("nonstrict", str), (beside("nonstrict"), beside)):
        variants = {
            rf"$\alpha_{{12}}$ = {alpha:g}": analyse_folder(results[named(name)].plan)
            for name, alpha in NONSTRICT_RUNS.items()
            if named(name) in results
        }
        if variants:
            save_png(variants_comparison(variants), folder / f"{picture}.png")
            written.add(f"{picture}.png")
    return frozenset(written)


def _log(result: Result) -> Path:
    return result.plan.folder / "log.npz"
