"""Figures 3, 4, 5 and 7 of gn_qn_2018 from our results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.kinematics import humanoid_test, planar_tests
from benchmarks.kinematics.variants import PAPER
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled

ERRORS, HAND = "gn_qn_errors.png", "gn_qn_hand.png"
_WIDTHS = {"gn_qn": 2.2}  # gn often lies on it
_LEVELS = ("feet, left hand", "large box", "right hand", "small box")


def plot_errors(results: Mapping[str, Any], path: Path) -> None:
    """Norms of the errors of both end effectors in T1 and T2 (figures 3 and 4)."""
    tests = [name for name in ("T1", "T2") if name in results]
    figure = new_figure(9.0, 2.6 * len(tests))
    with styled():
        grid = figure.subplots(len(tests), 2, squeeze=False, sharex=True)
    for axes, test in zip(grid, tests, strict=True):
        for end, ax in enumerate(axes):
            for index, name in enumerate(PAPER):
                if name not in results[test]:
                    continue
                trace = np.array(results[test][name]["trace"], dtype=float)
                steps = planar_tests.TRACE * np.arange(len(trace))
                ax.plot(
                    steps,
                    trace[:, end],
                    color=colour(index),
                    lw=_WIDTHS.get(name, 0.9),
                    label=name,
                )
            ax.set_yscale("log")
            ax.set_title(f"{test}: end effector {end + 2}")
        axes[0].set_ylabel("norm of the error [m]")
    for ax in grid[-1]:
        ax.set_xlabel("step")
    handles, labels = grid[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    save_png(figure, path)


def plot_hand(runs: Mapping[str, Any], path: Path) -> None:
    """T20: error of the right hand (figure 5), and where levels are augmented (figure 7)."""
    figure = new_figure(9.0, 4.6)
    with styled():
        top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    for index, name in enumerate(PAPER):
        if name not in runs:
            continue
        trace = np.array(runs[name]["trace"], dtype=float)
        steps = humanoid_test.TRACE * np.arange(len(trace))
        top.plot(steps, np.maximum(trace[:, 0], 1e-4), color=colour(index), lw=0.9, label=name)
        if name == "gn_qn":
            for level in range(len(_LEVELS)):
                used = steps[trace[:, 1 + level] > 0.5]
                bottom.plot(used, np.full(len(used), level), "|", color=colour(index), ms=7)
                bottom.axhline(level, color="#CCCCCC", lw=0.5, zorder=0)
            bottom.set_yticks(range(len(_LEVELS)), _LEVELS)
    bottom.set_ylim(-0.6, len(_LEVELS) - 0.4)
    bottom.invert_yaxis()
    bottom.set_title("gn_qn: levels with a second-order term")
    bottom.set_xlabel("step")
    top.set_yscale("log")
    top.set_ylabel("error, right hand [m]")
    top.legend(ncols=4)
    save_png(figure, path)
