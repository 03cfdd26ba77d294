"""Executes a run; writes and prints its results."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ghc_controller.errors import ConfigurationError
from ghc_sim_bridge.analysis.analysis import analyse, analyse_folder
from ghc_sim_bridge.analysis.balance_summary import balance_lines
from ghc_sim_bridge.analysis.claims import check_references
from ghc_sim_bridge.analysis.generator_analysis import CONSTRAINTS, analyse_generators
from ghc_sim_bridge.analysis.phase_table import outcome_lines, phase_table
from ghc_sim_bridge.analysis.summary import make_summary, rounded, write_json
from ghc_sim_bridge.errors import RenderingUnavailable
from ghc_sim_bridge.figures.comparison import variants_comparison
from ghc_sim_bridge.figures.filmstrip import write_filmstrip
from ghc_sim_bridge.figures.run import run_figures
from ghc_sim_bridge.figures.style import save_png
from ghc_sim_bridge.logs.controller_series import ControllerSeries
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.ros.run_experiment import run_experiment
from ghc_sim_bridge.run.folder_lock import folder_lock
from ghc_sim_bridge.scenario.plan import RunPlan
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.viewer.recording import write_rerun

SUMMARY = "summary.json"
RECORDING = "recording"


def run_and_report(plan: RunPlan) -> dict[str, Any]:
    """Run a plan, write its summary, figures and recordings, print the table of its phases.

    Returns the summary. Raises GhcError if the run failed or deviated from its script.
    """
    with folder_lock(plan.folder):
        return _run_and_report(plan)


def _run_and_report(plan: RunPlan) -> dict[str, Any]:
    outcome = run_experiment(plan)
    analysis = analyse(plan, outcome.log, outcome.robot)
    check_references(analysis.history, outcome.trace)
    summary = make_summary(analysis, outcome.trace, outcome.exit_codes, outcome.wall_seconds)
    if plan.scenario.generators:
        series = outcome.trace.constraints.series()
        series.save(plan.folder / CONSTRAINTS)
        summary["bounds"] = rounded(analyse_generators(analysis, series).summary())
    write_json(plan.folder / SUMMARY, summary)
    for name, figure in run_figures(analysis, outcome.trace).items():
        save_png(figure, plan.folder / f"{name}.png")
    _write_rerun(plan, analysis.log, outcome.robot)
    _write_filmstrip(plan, analysis.log)
    if plan.is_default:
        link_default(plan.folder)
    print(f"\n{plan.scenario.title}: {plan.scenario.name}, {plan.folder.name}")
    print(phase_table(summary))
    print(outcome_lines(summary))
    if balance := balance_lines(summary):
        print(balance)
    print(f"results: {plan.folder}", flush=True)
    return summary


def _write_rerun(plan: RunPlan, log: FullRateLog, robot: Path) -> None:
    """Write the run for the Rerun viewer; skipped without reports, e.g. after a full disk."""
    try:
        series = ControllerSeries.from_recording(plan.folder / RECORDING)
    except ConfigurationError as error:
        print(f"no recording.rrd: {error}", flush=True)
        return
    scene = load_scene(str(plan.parameters["sim_bridge"]["scene"]))
    write_rerun(plan.folder / "recording.rrd", log, series, scene, robot)


def _write_filmstrip(plan: RunPlan, log: FullRateLog) -> None:
    """Filmstrip for mobile robots; arms are better shown by an animation."""
    if log.base_pose is None:
        return
    scene = load_scene(str(plan.parameters["sim_bridge"]["scene"]))
    try:
        write_filmstrip(plan.folder / "filmstrip.png", log, scene)
    except RenderingUnavailable as error:
        print(f"no filmstrip.png: {error}", flush=True)


def link_default(folder: Path) -> None:
    """Link the files and the recording of the default variant into the parent folder."""
    scenario = folder.parent
    for entry in scenario.iterdir():
        if entry.is_symlink():
            entry.unlink()
    for entry in folder.iterdir():
        link = scenario / entry.name
        if (entry.is_file() or entry.name == RECORDING) and not link.exists():
            try:
                link.symlink_to(Path(folder.name) / entry.name)
            except OSError:  # a file system without symbolic links
                copy = shutil.copy2 if entry.is_file() else shutil.copytree
                copy(entry, link)


def compare_variants(plans: Sequence[RunPlan]) -> None:
    """One figure of all variants of a scenario that were run, next to their folders."""
    ordered = sorted(plans, key=lambda plan: plan.scenario.variant)
    analyses = {plan.scenario.variant: analyse_folder(plan) for plan in ordered}
    path = plans[0].folder.parent / "variants.png"
    save_png(variants_comparison(analyses), path)
    print(f"all variants: {path}", flush=True)


def went_well(summary: dict[str, Any]) -> bool:
    """Whether every node exited normally."""
    return all(code == 0 for code in summary["nodes"].values())
