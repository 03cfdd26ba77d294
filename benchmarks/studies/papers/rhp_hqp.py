"""The comparison of RHP-HQP (Han et al., 2021): avoidance by an upper body, and random orders."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.axes import Axes

import ghc_controller as ghc
from benchmarks import rhp_page
from benchmarks.ramps.order_ramps import SEED, SHARES, difference_to_hqp, ramps
from benchmarks.ramps.upper_body_loop import DT, Run, figures, run_case
from benchmarks.rhp_page import DISPLAYED_CASE, DISPLAYED_W
from benchmarks.study_results import shown
from benchmarks.upper_body_cases import CASES, ROBOT
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.markdown import table as markdown_table
from tools.model_packages import install_missing
from tools.workspace.layout import Layout

NAME = "rhp_hqp"
TITLE = "Upper body of iCub avoids an obstacle, as in the RHP-HQP paper"
FORMULATIONS = ("rhp_hqp", "hqp_transition", "hqp", "cascade", "ghc")
FIGURE = "rhp_hqp.png"
CAPTION = (
    "Left: way of the answer while a task above a posture is removed, median of random problems. "
    "Right: error of the hand in case 2 with the timed ramp, w = 1e-4."
)
PAGE = "rhp_hqp.md"
page = rhp_page.page
_W = (1e-4, 1e-2)
_BOTH_DAMPED = ("hqp_transition", "cascade")  # compared with the default velocity damping as well
_PROBLEMS, _STRICT_PROBLEMS = 60, 200
_SAMPLE = 0.1  # [s] of the error over time
_WIDTHS = (4.0, 2.6, 1.2, 1.2, 1.2)  # of curves: `cascade` and `hqp_transition` are nearly one


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Four closed-loop cases and random problems, each at two weights of regularization.

    The timed ramp also with the default velocity damping, towards -kd v for both.
    """
    install_missing("icub-models", Layout(Path(__file__).resolve().parents[3]))
    count, strict = (1, 2) if quick else (_PROBLEMS, _STRICT_PROBLEMS)
    duration = 0.2 if quick else None
    found = {}
    for name in formulations:
        cases: dict[str, dict[str, Any]] = {f"{w:g}": {} for w in _W}
        random: dict[str, Any] = {}
        for w in _W:
            settings = ghc.FormulationSettings(regularization=w, velocity_damping=0.0)
            random[f"{w:g}"] = ramps(name, settings, count)
            for case in CASES.values():
                done = run_case(case, name, settings, duration=duration)
                cases[f"{w:g}"][case.name] = figures(done)
                if case.name == DISPLAYED_CASE and w == DISPLAYED_W:
                    over_time = _sampled(done)
        found[name] = {"cases": cases, "random": random, "hand_mm": over_time}
        if name in _BOTH_DAMPED:
            found[name]["damped_ramp"] = {f"{w:g}": _damped_ramp(name, w, duration) for w in _W}
        if name == "rhp_hqp":
            found[name] |= _constant_weights(count)
            settings = ghc.FormulationSettings(velocity_damping=0.0)
            found[name]["apart_from_hqp"] = difference_to_hqp(name, settings, strict)
    facts = {
        "robot": ROBOT,
        "period_s": DT,
        "w": list(_W),
        "problems": count,
        "strict_problems": strict,
        "seed": SEED,
        "sample_s": _SAMPLE,
        "duration_s": duration,
    }
    return {"facts": facts, "formulations": found}


def _damped_ramp(name: str, w: float, duration: float | None) -> dict[str, Any]:
    settings = ghc.FormulationSettings(regularization=w, hqp_damps_velocity=True)
    return figures(run_case(CASES["ramp"], name, settings, duration=duration))


def _constant_weights(count: int) -> dict[str, Any]:
    settings = ghc.FormulationSettings(velocity_damping=0.0, rhp_constant_weights=True)
    return {"constant_weights": ramps("rhp_hqp", settings, count)}


def _sampled(run: Run) -> list[float]:
    return [1e3 * float(error) for error in run.position[:: round(_SAMPLE / DT)]]


def table(result: dict[str, Any]) -> str:
    """Cases by formulation and w, then the random problems."""
    facts, lines, random = result["facts"], [], []
    for name, row in result["formulations"].items():
        for w, cases in row["cases"].items():
            for case, values in cases.items():
                lines.append([name, w, CASES[case].title, *rhp_page.case_cells(values)])
            random.append([name, w, *rhp_page.random_cells(row["random"][w])])
        if "constant_weights" in row:
            label = f"{name}, constant weights"
            random.append([label, "0.01", *rhp_page.random_cells(row["constant_weights"])])
    apart = result["formulations"].get("rhp_hqp", {}).get("apart_from_hqp")
    return (
        f"Closed loop of `{facts['robot']}` with the simulator, period "
        f"{1e3 * facts['period_s']:g} ms, `velocity_damping` 0 as in the papers, regularization "
        "w. Beside the figures of the paper, with what differs: [rhp_hqp.md](rhp_hqp.md).\n\n"
        + markdown_table(["formulation", "w", "case", *rhp_page.CASE_HEAD], lines)
        + f"\n\nMedians of {facts['problems']} random problems (seed {facts['seed']}), 7 joints, "
        "rows 3 + 3 + 7. Swap: two tasks with the same Jacobian above a posture. Removal: the "
        "second of two tasks above a posture. A step is the largest of 100 equal ones over the "
        "whole change, a jump what both ends add within 1e-9 of the ramp. At strict orders "
        f"`rhp_hqp` and `hqp` differ by at most {shown(apart, '.1e')} (relative; "
        f"{facts['strict_problems']} problems each with 7 and 17 joints, bounds off and on).\n\n"
        + markdown_table(["formulation", "w", *rhp_page.RANDOM_HEAD], random)
    )


def plot(result: dict[str, Any], path: Path) -> None:
    """Removal over the share on the left, error of the hand over time on the right."""
    figure = new_figure(9.6, 3.4)
    with styled():
        left, right = figure.subplots(1, 2)
    for index, (name, row) in enumerate(result["formulations"].items()):
        for w, style in zip(row["random"], ("--", "-"), strict=True):
            if name == "rhp_hqp" or w == "0.01":
                _line(left, SHARES, row["random"][w]["removed"], index, f"{name}, w = {w}", style)
        times = [k * result["facts"]["sample_s"] for k in range(len(row["hand_mm"]))]
        _line(right, times, row["hand_mm"], index, name, "-")
    left.set_xlabel("share of the order without the task")
    left.set_ylabel("way of the answer")
    right.set_xlabel("time [s]")
    right.set_ylabel("error of the hand [mm]")
    for ax in (left, right):
        ax.legend(fontsize=7)
        ax.grid(True)
    save_png(figure, path)


def _line(ax: Axes, x: Any, y: Any, index: int, label: str, style: str) -> None:
    ax.plot(x, y, color=colour(index), linestyle=style, label=label, lw=_WIDTHS[index])
