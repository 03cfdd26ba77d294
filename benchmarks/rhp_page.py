"""Writes docs/rhp_hqp.md: tables of the RHP-HQP paper next to those of the study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.ramps.rhp_asked import asked_table
from benchmarks.upper_body_cases import CASES
from ghc_sim_bridge.programs.markdown import number
from ghc_sim_bridge.programs.markdown import table as markdown_table

_TEMPLATE = Path(__file__).with_name("rhp_page.md")
DISPLAYED_CASE, DISPLAYED_W = "ramp", 1e-4  # of the figure
CASE_HEAD = (
    "hand, max [mm]",
    "hand, integral [mm s]",
    "hand, end [mm]",
    "orientation, max [rad]",
    "gap of the elbow, min [mm]",
    "torque rate [Nm/s @ 1 ms]",
    "QPs per step, one order",
    "QPs per step, mixed",
    "CPU [us], one order",
    "CPU [us], mixed",
)
RANDOM_HEAD = ("jump at the ends of a swap", "step of a swap", "step of a removal")
_ORDER = ("rhp_hqp", "hqp_transition", "hqp", "cascade", "ghc")
PAPER_1 = {"rhp_hqp": "0.34", "hqp": "0.34", "ghc": "12.7"}  # [mm]
PAPER_2 = {  # [m] as printed, and the integral
    "rhp_hqp": ("0.17", "0.32"),
    "hqp_transition": ("0.21", "0.42"),
    "ghc": ("0.21", "0.58"),
}
PAPER_3 = {  # [ms] average without and during a transition
    "rhp_hqp": (0.059, 0.061),
    "hqp_transition": (0.063, 0.098),
    "ghc": (0.060, 0.061),
}

Result = Mapping[str, Any]


def case_cells(values: Mapping[str, Any]) -> list[str]:
    """Cells of CASE_HEAD."""
    keys = ("max_mm", "integral_mm_s", "end_mm", "turn_max_rad", "gap_mm", "rate_nm_s")
    counts = ("qps_one", "qps_mixed", "cpu_one_us", "cpu_mixed_us")
    return [_short(values[key]) for key in (*keys, *counts)]


def random_cells(values: Mapping[str, Any]) -> list[str]:
    """Cells of RANDOM_HEAD."""
    steps = [number(100.0 * values[key]) + " %" for key in ("swap_step", "removal_step")]
    return [number(values["swap_jump"]), *steps]


def page(result: Result) -> str:
    """Markdown of docs/rhp_hqp.md: `rhp_page.md` with its tables from a stored result.

    A table that compares formulations needs all that it names.
    """
    text = _TEMPLATE.read_text(encoding="utf-8")
    text = text.replace("<!-- commit -->", result.get("commit") or "not recorded")
    for name, write in _TABLES.items():
        text = text.replace(f"<!-- table: {name} -->", write(result))
    return text


def _of(result: Result, name: str, w: str, case: str, key: str) -> Any:
    return result["formulations"][name]["cases"][w][case][key]


def _case_1(result: Result) -> str:
    rows = [
        [name, PAPER_1.get(name, "-")]
        + [
            _short(_of(result, name, w, "constant", key))
            for key in ("max_mm", "turn_max_rad")
            for w in _weights(result)
        ]
        for name in _names(result)
    ]
    head = ["formulation", "paper, hand [mm]"]
    head += [f"{what}, w = {w}" for what in ("hand [mm]", "turn [rad]") for w in _weights(result)]
    return markdown_table(head, rows)


def _case_2(result: Result) -> str:
    rows = []
    for name in _names(result):
        for w in _weights(result):
            cells = [
                _short(_of(result, name, w, case, key) / 1e3)
                for case in ("distance", "ramp")
                for key in ("max_mm", "integral_mm_s")
            ]
            gaps = [_short(_of(result, name, w, case, "gap_mm")) for case in ("distance", "ramp")]
            rows.append([name, w, *PAPER_2.get(name, ("-", "-")), *cells, *gaps])
    head = ["formulation", "w", "paper, max [m]", "paper, integral"]
    for case in ("by distance", "timed"):
        head += [f"{case}, max [m]", f"{case}, integral [m s]"]
    head += ["by distance, gap [mm]", "timed, gap [mm]"]
    return markdown_table(head, rows)


def _times(result: Result) -> str:
    rows = []
    w = _weights(result)[0]
    for name in _names(result):
        paper = ["-", "-", "-"]
        if name in PAPER_3:
            one, mixed = PAPER_3[name]
            paper = [f"{one:.3f}", f"{mixed:.3f}", f"{mixed / one:.2f}"]
        cpu = [_of(result, name, w, "distance", f"cpu_{kind}_us") for kind in ("one", "mixed")]
        qps = [_of(result, name, w, "distance", f"qps_{kind}") for kind in ("one", "mixed")]
        ratio = None if None in cpu else cpu[1] / cpu[0]
        rows.append([name, *paper, *map(_short, (*cpu, ratio)), *map(_short, qps)])
    head = ["formulation", "paper, one order [ms]", "paper, transition [ms]", "ratio"]
    head += ["CPU, one order [us]", "CPU, transition [us]", "ratio"]
    head += ["QPs per step, one order", "QPs per step, transition"]
    return markdown_table(head, rows)


def _case_3(result: Result) -> str:
    rows = [
        [name, w]
        + [
            _short(_of(result, name, w, "reactive", key))
            for key in ("max_mm", "integral_mm_s", "end_mm", "turn_max_rad", "gap_mm", "rate_nm_s")
        ]
        for name in _names(result)
        for w in _weights(result)
    ]
    head = ["formulation", "w", *CASE_HEAD[:6]]
    return markdown_table(head, rows)


def _against_cascade(result: Result) -> str:
    present = result["formulations"]
    if not {"cascade", "hqp_transition"} <= set(present):
        return ""
    rows = []
    for w in _weights(result):
        for case in CASES.values():
            values = [
                _of(result, name, w, case.name, "integral_mm_s")
                for name in ("cascade", "hqp_transition", "rhp_hqp", "ghc")
                if name in present
            ]
            ratios = [_short(values[0] / other) for other in values[1:]]
            rows.append([case.title, w, _short(values[0]), *ratios])
    names = [name for name in ("hqp_transition", "rhp_hqp", "ghc") if name in present]
    head = ["case", "w", "integral [mm s]", *(f"over {name}" for name in names)]
    return markdown_table(head, rows)


def _random(result: Result) -> str:
    rows = []
    for name in _names(result):
        row = result["formulations"][name]
        rows += [[name, w, *random_cells(row["random"][w])] for w in _weights(result)]
        if "constant_weights" in row:
            rows.append(["constant weights", "0.01", *random_cells(row["constant_weights"])])
    return markdown_table(["formulation", "w", *RANDOM_HEAD], rows)


def _names(result: Result) -> list[str]:
    return [name for name in _ORDER if name in result["formulations"]]


def _short(value: float | None) -> str:
    return number(value, 3)


def _weights(result: Result) -> list[str]:
    return [f"{w:g}" for w in result["facts"]["w"]]


_TABLES = {
    "asked": asked_table,
    "case_1": _case_1,
    "case_2": _case_2,
    "times": _times,
    "case_3": _case_3,
    "against_cascade": _against_cascade,
    "random": _random,
}
