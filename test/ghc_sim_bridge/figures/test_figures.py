"""Figures of a run made up here: which ones exist, what they show, how large their files are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_run import DT, made_up
from PIL import Image

from ghc_sim_bridge.analysis.phase_table import outcome_lines, phase_table
from ghc_sim_bridge.analysis.summary import make_summary, rounded, write_json
from ghc_sim_bridge.colors import PALETTE, rgb
from ghc_sim_bridge.figures.comparison import torque_comparison
from ghc_sim_bridge.figures.run import run_figures
from ghc_sim_bridge.figures.style import (
    envelope,
    new_figure,
    run_title,
    save_png,
    short_hierarchy,
    styled,
)
from ghc_sim_bridge.figures.tasks import alpha_panels
from ghc_sim_bridge.logs.controller_trace import ControllerTrace
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

PNG_LIMIT = 150_000  # [bytes] so that figures can stand beside the documentation
REQUIRED = {
    "scenario",
    "robot",
    "formulation",
    "control_dt_s",
    "sim_seconds",
    "wall_seconds",
    "real_time_factor",
    "nodes",
    "phases",
    "peak_torque_rate_nm_per_s",
    "peak_torque_jump_nm",
    "jerk_integral",
    "limit_violations",
    "rest",
    "solve_time_us",
    "step_time_us",
    "qp_failures",
    "fallback_ticks",
    "torque_rate_limit_nm_per_s",
    "paper",
}


def test_a_run_has_the_figures_that_its_data_allow(tmp_path: Path) -> None:
    static = run_figures(*made_up(tmp_path, "priority_switching"))
    moving = run_figures(*made_up(tmp_path, "lemniscate"))
    assert set(static) == {"tasks", "joints", "jerk"}
    assert set(moving) == set(static) | {"path_end_effector"}


@pytest.mark.parametrize("scenario", ["priority_switching", "lemniscate"])
def test_png_files_are_readable_and_small(tmp_path: Path, scenario: str) -> None:
    for name, figure in run_figures(*made_up(tmp_path, scenario)).items():
        path = tmp_path / f"{name}.png"
        save_png(figure, path)
        assert path.read_bytes().startswith(b"\x89PNG")
        assert path.stat().st_size < PNG_LIMIT


def test_a_torque_rate_is_never_shown_without_its_control_period(tmp_path: Path) -> None:
    analysis, trace = made_up(tmp_path, "priority_switching")
    labels = [axes.get_ylabel() for axes in run_figures(analysis, trace)["joints"].axes]
    rates = [label for label in labels if "Nm/s" in label]
    assert rates and all("1 ms" in label for label in rates)
    summary = make_summary(analysis, trace, {"sim_bridge": 0}, 10.0)
    assert "Nm/s @ 1 ms" in phase_table(summary)


def test_torques_of_two_runs_stand_on_the_same_axes_with_rate_and_period(tmp_path: Path) -> None:
    analysis, trace = made_up(tmp_path, "priority_switching")
    summary = make_summary(analysis, trace, {"sim_bridge": 0}, 10.0)
    log = analysis.log
    larger = replace(log, torque=2.0 * log.torque)
    axes = torque_comparison({"small": (summary, log), "large": (summary, larger)}).axes
    assert axes[0].get_ylim() == axes[1].get_ylim()
    start = summary["phases"][1]["t_start"]
    for ax, shown in zip(axes, (log, larger), strict=True):
        time, torque = map(np.asarray, ax.lines[0].get_data())
        rows = np.searchsorted(log.time, time + start - 1e-9)
        assert np.array_equal(torque, shown.torque[rows, 0])
        assert time[0] < 0.0 < time[-1] and "Nm/s at 1 ms" in ax.get_title()


def test_summary_has_every_promised_field(tmp_path: Path) -> None:
    analysis, trace = made_up(tmp_path, "priority_switching")
    summary = make_summary(analysis, trace, {"sim_bridge": 0}, 10.0)
    assert set(summary) >= REQUIRED
    assert [phase["hierarchy"] for phase in summary["phases"]] == [
        planned.phase.hierarchy for planned in analysis.plan.phases
    ]
    assert all(set(phase["errors"]) == set(trace.tasks) for phase in summary["phases"])
    assert summary["torque_rate_limit_nm_per_s"] is None
    # The step of 3 Nm is the largest jump, in the phase in which it is, and nowhere else.
    jumps = summary["peak_torque_jump_nm"]
    middle = 0.5 * analysis.plan.duration
    step = [phase["t_start"] <= middle < phase["t_end"] for phase in summary["phases"]].index(True)
    assert jumps["total"] == jumps["per_phase"][step] == pytest.approx(3.0, abs=0.01)
    assert summary["peak_torque_rate_nm_per_s"]["total"] == pytest.approx(jumps["total"] / DT)
    write_json(tmp_path / "summary.json", summary)


def test_a_robot_that_moves_at_the_end_of_its_phases_is_named_in_summary_and_table(
    tmp_path: Path,
) -> None:
    """Joints swing at up to 0.12 rad/s: with constant targets that is motion that is left."""
    analysis, trace = made_up(tmp_path, "priority_switching")
    summary = make_summary(analysis, trace, {"sim_bridge": 0}, 10.0)
    rest = summary["rest"]
    assert rest["moving_phases"] == [1, 2, 3, 4, 5]
    assert rest["window_s"] == [3.0] * 5
    assert all(0.05 < speed <= 0.12 for speed in rest["mean_speed_rad_per_s"])
    assert "joints still move at the end of phases 1, 2, 3, 4, 5" in outcome_lines(summary)
    summary["rest"]["moving_phases"] = []
    assert "still move" not in outcome_lines(summary)
    followed, trace = made_up(tmp_path, "lemniscate")
    summary = make_summary(followed, trace, {"sim_bridge": 0}, 10.0)
    assert summary["rest"]["moving_phases"] == []
    assert max(summary["rest"]["mean_speed_rad_per_s"]) > 0.05


def test_a_budget_of_the_transitions_is_told(tmp_path: Path) -> None:
    analysis, trace = made_up(tmp_path, "priority_switching")
    assert make_summary(analysis, trace, {}, 10.0)["transition_torque_rate_nm_per_s"] is None
    assert run_title(analysis).count("Nm/s") == 0
    plan = make_plan(load_scenario("priority_switching"), RunOptions(torque_rate=50.0), tmp_path)
    budgeted = replace(analysis, plan=plan)
    assert make_summary(budgeted, trace, {}, 10.0)["transition_torque_rate_nm_per_s"] == 50.0
    assert "transitions of at least 2 s, 50 Nm/s" in run_title(budgeted)


def test_errors_are_distances_to_the_references_of_the_scenario(tmp_path: Path) -> None:
    analysis, _ = made_up(tmp_path, "priority_switching")
    posture = next(task for task in analysis.history.tasks if task.name == "posture")
    reference = next(r for r in analysis.plan.scenario.references if r.task == "posture")
    goal = np.array(reference.points[0].position)
    q = analysis.log.q[analysis.history.rows]
    np.testing.assert_allclose(posture.error, np.linalg.norm(goal - q, axis=1), atol=1e-12)
    assert analysis.phase_errors[-1]["posture"] == posture.error[-1]


def test_hierarchies_are_shortened_to_the_papers_numbers() -> None:
    tasks = ("end_effector", "elbow", "posture")
    assert short_hierarchy("posture > elbow > end_effector", tasks) == "3 ▷ 2 ▷ 1"
    assert short_hierarchy("elbow = end_effector", tasks) == "2 = 1"


def test_an_envelope_keeps_every_peak() -> None:
    values = np.random.default_rng(2).uniform(size=1000)
    time, kept = envelope(np.arange(1000.0), values, 10)
    assert len(time) == len(kept) == 100
    assert kept.max() == values.max()


def test_json_holds_no_number_that_json_does_not_know() -> None:
    assert rounded({"a": [np.float64("nan"), np.inf, np.int64(3), 0.12345678949]}) == {
        "a": [None, None, 3, 0.123456789]
    }


def test_of_many_tasks_only_the_priorities_that_change_are_drawn() -> None:
    """Six tasks, of which the last two swap: one panel, and the file warns of nothing."""
    alpha = np.triu(np.ones((6, 6)), 1).T
    swapped = alpha.copy()
    swapped[4, 5], swapped[5, 4] = 1.0, 0.0
    trace = ControllerTrace(tasks=tuple("abcdef"))
    trace.time = [0.0, 1.0]
    trace.alpha = [matrix.ravel().tolist() for matrix in (alpha, swapped)]
    assert alpha_panels(trace) == [[(4, 5), (5, 4)]]
    trace.alpha = [alpha.ravel().tolist()] * 2
    assert alpha_panels(trace) == [[(0, 1), (1, 0)]]


def test_many_tasks_are_rows_of_the_table(tmp_path: Path) -> None:
    """A table fits a terminal however many tasks there are, and holds the same figures."""
    analysis, trace = made_up(tmp_path, "priority_switching")
    summary = make_summary(analysis, trace, {"sim_bridge": 0}, 10.0)
    few = phase_table(summary)
    extra = {f"extra_{k}": "m" for k in range(4)}
    summary["error_units"] |= extra
    for phase in summary["phases"]:
        phase["errors"] |= dict.fromkeys(extra, 1.234e-3)
    many = phase_table(summary)
    assert max(map(len, many.splitlines())) < 100 < max(map(len, few.splitlines()))
    assert many.count("1.23e-03") == len(extra) * len(summary["phases"])
    for phase in summary["phases"]:
        assert f"{phase['errors']['elbow']:.2e}" in many and phase["hierarchy"] in many


def test_a_path_is_drawn_of_three_axes_alone(tmp_path: Path) -> None:
    """A center of mass over the ground has two."""
    analysis, trace = made_up(tmp_path, "lemniscate")
    history = analysis.history
    first, *others = history.tasks
    flat = replace(first, reference=first.reference[:, :2], position=first.position[:, :2])
    analysis = replace(analysis, history=replace(history, tasks=(flat, *others)))
    assert "path_end_effector" not in run_figures(analysis, trace)


def test_a_file_keeps_the_colors_of_few_pixels(tmp_path: Path) -> None:
    """A curve that others hide has its color at least in the legend, which tells them apart."""
    path, figure = tmp_path / "many.png", new_figure(6.0, 3.0)
    with styled():
        ax = figure.subplots()
        ax.imshow(np.random.default_rng(0).random((40, 40, 3)))
        for index, color in enumerate(PALETTE):
            ax.plot(3.0 * index, 20.0, "s", ms=4.0, mew=0.0, color=color)
    save_png(figure, path)
    with Image.open(path) as image:
        found = {color for _, color in image.convert("RGB").getcolors(1 << 24) or []}
    assert {rgb(index) for index in range(len(PALETTE))} <= found
