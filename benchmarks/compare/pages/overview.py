"""The overview figure: every method in every case, one panel per figure."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

from benchmarks.compare.case import GROUPS, Case
from benchmarks.compare.cases import CASES
from benchmarks.compare.method import METHODS, REFERENCE, UNDAMPED
from benchmarks.compare.pages.assessment import LEAST, RATIO
from benchmarks.compare.store import Results
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled

Value = Callable[[Case, Mapping[str, Any], Mapping[str, Any]], float | None]
_SHIFT = 0.15  # between the rows of two groups
_MARKS = ("o", "s", "^", "D", "v")  # of the groups
_COLORS = (0, 1, 2, 6, 3)  # of the palette


def deciding_ratio(
    case: Case, result: Mapping[str, Any], reference: Mapping[str, Any]
) -> float | None:
    """Error over that of the reference at the first level where they differ; 1 where none does.

    The largest one over the phases, or the smallest where none is above 1.
    """
    if case.figure == "none" or result.get("stopped_s") is not None:
        return None
    found = []
    for theirs, mine in zip(result["phases"], reference["phases"], strict=False):
        for one, another in zip(theirs["tasks"], mine["tasks"], strict=True):
            a, b = one[case.figure], another[case.figure]
            if a > RATIO * b + LEAST or b > RATIO * a + LEAST:
                found.append((a + LEAST) / (b + LEAST))
                break
        else:
            found.append(1.0)
    largest = max(found, default=None)
    return largest if largest is None or largest > 1.0 else min(found)


def _of(key: str, least: float = 0.0) -> Value:
    def value(
        case: Case,  # noqa: ARG001
        result: Mapping[str, Any],
        reference: Mapping[str, Any],  # noqa: ARG001
    ) -> float | None:
        found = result.get(key)
        return None if found is None else max(float(found), least)

    return value


_PANELS: tuple[tuple[str, Value, float], ...] = (  # title, value, where an ideal one stands
    (f"error over that of {REFERENCE},\nfirst level that differs", deciding_ratio, 1.0),
    ("loss of a level to those below,\nbounds met", _of("strict_any", 1e-12), np.nan),
    ("largest of 100 steps of a ramp\nover its whole change", _of("ramp_step"), 0.01),
    ("torque rate while orders change\n[Nm/s]", _of("torque_rate_changing", 1e-2), np.nan),
    ("QPs per step\n(0 drawn at 0.01)", _of("qps", 0.01), np.nan),
    ("operations per step", _of("operations"), np.nan),
)


def plot_overview(results: Results, path: Path) -> None:
    """Rows are methods, a dot is a case, its color the group of the case."""
    methods = [
        name for name in METHODS | UNDAMPED if any(name in each for each in results.values())
    ]
    figure = new_figure(10.0, 1.6 + 0.22 * len(methods) * 2)
    with styled():
        places = figure.subplots(2, 3, sharey=True)
    for ax, (title, value, ideal) in zip(places.flat, _PANELS, strict=True):
        for group, points in _points(results, methods, value).items():
            index = GROUPS.index(group)
            rows = [row + _SHIFT * (index - 0.5 * (len(GROUPS) - 1)) for row, _ in points]
            values = [each for _, each in points]
            mark = _MARKS[index]
            ax.plot(values, rows, mark, ms=4.5, mew=0, color=colour(_COLORS[index]), label=group)
        _finish(ax, title, methods)
        drawn = [each for line in ax.get_lines() for each in line.get_xdata()]
        if drawn:  # room beside the dots, also where all are alike
            ax.set_xlim(min(drawn) / 1.6, max(drawn) * 1.6)
        if np.isfinite(ideal):
            ax.axvline(ideal, color="#999999", lw=0.8, zorder=0)
    handles: dict[str, Any] = {}
    for ax in places.flat:
        handles |= dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    order = [group for group in GROUPS if group in handles]
    figure.legend(
        [handles[group] for group in order], order, loc="outside lower center", ncols=len(GROUPS)
    )
    save_png(figure, path)


def _points(
    results: Results, methods: list[str], value: Value
) -> dict[str, list[tuple[int, float]]]:
    found: dict[str, list[tuple[int, float]]] = {}
    for case, row, each in _values(results, methods, value):
        found.setdefault(case.group, []).append((row, each))
    return found


def _values(
    results: Results, methods: list[str], value: Value
) -> Iterator[tuple[Case, int, float]]:
    for name, by_method in results.items():
        reference = by_method.get(REFERENCE)
        for method, result in by_method.items():
            if reference is None or "rejected" in result or "rejected" in reference:
                continue
            each = value(CASES[name], result, reference)
            if each is not None and each > 0.0:
                yield CASES[name], methods.index(method), each


def _finish(ax: Axes, title: str, methods: list[str]) -> None:
    ax.set_xscale("log")
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_title(title, fontsize=8.5)
    ax.set_yticks(range(len(methods)), methods)
    ax.set_ylim(len(methods) - 0.5, -0.5)
    for row in range(0, len(methods), 2):
        ax.axhspan(row - 0.5, row + 0.5, color="#F4F4F4", zorder=0, lw=0)
    ax.grid(True, axis="x")
    ax.grid(False, axis="y")
