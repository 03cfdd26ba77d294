"""Tables of docs/gn_qn.md from the results alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from benchmarks.kinematics.paper_table import TABLE
from benchmarks.kinematics.planar_tests import STATIC
from benchmarks.kinematics.variants import ABLATIONS, HUMANOID, PAPER, REFERENCE
from ghc_sim_bridge.markdown import table

Results = Mapping[str, Any]

_LONG = "T20/10000"
_PSI = {4, 6, 7, 8}  # tests whose Psi of gn_qn is asked for


def table_i(results: Results) -> str:
    """Both columns of Table I: the paper's entry, ours in bold."""
    head = ["test", *(f"{name}, paper" if ours == 0 else name for name in PAPER for ours in (0, 1))]
    rows = []
    for number in range(1, 20):
        if f"T{number}" not in results:
            continue
        row = [f"T{number}"]
        for name in PAPER:
            row += [TABLE[name][number - 1], f"**{entry(results, number, name)}**"]
        rows.append(row)
    return table(head, rows)


def ablation_table(results: Results) -> str:
    """Sigma / Xi - Psi of the variants that are not in the paper."""
    rows = [
        [f"T{number}", *(entry(results, number, name) for name in ABLATIONS)]
        for number in range(1, 20)
        if f"T{number}" in results
    ]
    return table(["test", *ABLATIONS], rows)


def humanoid_table(results: Results) -> str:
    """T20 at both speeds of the target."""
    head = ["steps", "variant", "Sigma [rad]", "Sigma, share of gn", "sum of abs(e), right hand [m]"]
    head += ["over gn", "box violated by [m]", "levels augmented: hand, small box"]
    head += ["CPU per step, median [us]", "over gn", "unsolved levels"]
    rows = []
    for key in sorted(key for key in results if key.startswith("T20")):
        base = results[key].get("gn")
        for name in (name for name in HUMANOID if name in results[key]):
            r = results[key][name]
            over = ["-"] * 3
            if base:
                over = [f"{r[k] / base[k]:.3g}" for k in ("sigma", "hand", "cpu_us")]
            rows.append([
                key.partition("/")[2], name, f"{r['sigma']:.3g}", over[0], f"{r['hand']:.4g}",
                over[1], f"{r['box_m']:.1e}",
                f"{100 * r['augmented'][2]:.0f} %, {100 * r['augmented'][3]:.0f} %",
                f"{r['cpu_us']:.0f}", over[2], str(r["unsolved"]),
            ])  # fmt: skip
    return table(head, rows)


def check_table(results: Results) -> str:
    """What was asked for, beside what was measured."""
    rows: list[list[str]] = []
    for name, asked, numbers in (
        ("gn", (574, 912, 775, 890, 971), (1, 10, 15, 17, 18)),
        ("dhqp", (828, 808, 806), (7, 10, 12)),
    ):
        for want, number in zip(asked, numbers, strict=True):
            found = _value(results, number, name, "sigma")
            rows.append(_row(f"Sigma, {name}, T{number}", f"{want} ± 3 %", found,
                             lambda x, want=want: abs(x / want - 1.0) <= 0.03))  # fmt: skip
    for want, number in zip((169, 163, 205), (4, 6, 8), strict=True):
        found = _value(results, number, "gn", "psi")
        rows.append(_row(f"Psi, gn, T{number}", f"{want} ± 2", found,
                         lambda x, want=want: abs(x - want) <= 2))  # fmt: skip
    numbers = [n for n in range(1, 20) if f"T{n}" in results]
    if numbers:
        worst = {n: _value(results, n, "gn_qn", "sigma") or 0.0 for n in numbers}
        at = max(worst, key=lambda n: worst[n])
        rows.append(_row(f"Sigma, gn_qn, largest of T1 to T19 (T{at})", "at most 1", worst[at],
                         lambda x: x <= 1.0))  # fmt: skip
        ratios = {n: xi(results, n, "gn_qn") or 0.0 for n in numbers}
        at = max(ratios, key=lambda n: ratios[n])
        rows.append(_row(f"Xi, gn_qn, largest of T1 to T19 (T{at})", "at most 1.03", ratios[at],
                         lambda x: x <= 1.03))  # fmt: skip
    for name, number in [*(("gn_qn", n) for n in sorted(_PSI)), ("newton", 5)]:
        found = _value(results, number, name, "psi")
        rows.append(_row(f"Psi, {name}, T{number}", "at most 220", found, lambda x: x <= 220))
    if {"gn", "gn_qn"} <= set(results.get(_LONG, {})):
        gn, qn = results[_LONG]["gn"], results[_LONG]["gn_qn"]
        for label, asked, value, most in (
            ("Sigma over that of gn", "at most 0.01", qn["sigma"] / gn["sigma"], 0.01),
            ("error integral over that of gn", "at most 1.02", qn["hand"] / gn["hand"], 1.02),
            ("CPU per step over that of gn", "at most 2.5", qn["cpu_us"] / gn["cpu_us"], 2.5),
            ("large box violated by [m]", "at most 1e-4", qn["box_m"], 1e-4),
        ):
            rows.append(_row(f"T20, gn_qn: {label}", asked, value, lambda x, most=most: x <= most))
    return table(["figure", "asked", "measured", "met"], rows)


def entry(results: Results, number: int, name: str) -> str:
    """Sigma / Xi - Psi of one cell; - where it was not run."""
    figures = results[f"T{number}"].get(name)
    if figures is None:
        return "-"
    ratio = xi(results, number, name)
    text = f"{figures['sigma']:.3g}" + (f" / {ratio:.3g}" if ratio is not None else "")
    if number in STATIC and figures["psi"] is not None:
        text += f" - {figures['psi']}"
    return text


def xi(results: Results, number: int, name: str) -> float | None:
    """Integral of the error of level 1 over the least one of REFERENCE."""
    test = results[f"T{number}"]
    known = [test[other]["e1"] for other in REFERENCE if other in test]
    if not known or name not in test:
        return None
    return float(test[name]["e1"] / min(known))


def _value(results: Results, number: int, name: str, key: str) -> float | None:
    value = results.get(f"T{number}", {}).get(name, {}).get(key)
    return None if value is None else float(value)


def _row(
    label: str, asked: str, value: float | None, is_met: Callable[[float], bool]
) -> Sequence[str] | Any:
    if value is None:
        return [label, asked, "-", "-"]
    return [label, asked, f"{value:.4g}", "yes" if is_met(value) else "**no**"]
