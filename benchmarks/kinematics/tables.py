"""Tables of docs/gn_qn.md from the results alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchmarks.kinematics.paper_table import TABLE
from benchmarks.kinematics.planar_tests import STATIC
from benchmarks.kinematics.variants import ABLATIONS, HUMANOID, PAPER, REFERENCE
from ghc_sim_bridge.programs.markdown import table

Results = Mapping[str, Any]

_LONG = "T20/10000"


def table_i(results: Results) -> str:
    """Both columns of Table I: the paper's entry, ours in bold."""
    head = [
        "test",
        *(f"{name}, paper" if ours == 0 else name for name in PAPER for ours in (0, 1)),
    ]
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
    head = [
        "steps",
        "variant",
        "Sigma [rad]",
        "Sigma, share of gn",
        "sum of abs(e), right hand [m]",
    ]
    head += ["over gn", "box violated by [m]", "levels augmented: hand, small box"]
    head += ["CPU per step, median [us]", "over gn", "unsolved levels"]
    rows = []
    for key in sorted(key for key in results if key.startswith("T20")):
        base = results[key].get("gn")
        for name in (name for name in HUMANOID if name in results[key]):
            r = results[key][name]
            over = ["-"] * 3
            if base:
                over = [f"{r[k] / base[k]:.4g}" for k in ("sigma", "hand", "cpu_us")]
            rows.append([
                key.partition("/")[2], name, f"{r['sigma']:.3g}", over[0], f"{r['hand']:.4g}",
                over[1], f"{r['box_m']:.1e}",
                f"{100 * r['augmented'][2]:.0f} %, {100 * r['augmented'][3]:.0f} %",
                f"{r['cpu_us']:.0f}", over[2], str(r["unsolved"]),
            ])  # fmt: skip
    return table(head, rows)


def check_table(results: Results) -> str:
    """Goals next to measured values."""
    rows = []
    for number, sigma in {1: 574, 10: 912, 15: 775, 17: 890, 18: 971}.items():
        rows.append(_near(results, number, "gn", "sigma", sigma, 0.03 * sigma, "± 3 %"))
    for number, psi in {4: 169, 6: 163, 8: 205}.items():
        rows.append(_near(results, number, "gn", "psi", psi, 2.0, "± 2"))
    for number, sigma in {7: 828, 10: 808, 12: 806}.items():
        rows.append(_near(results, number, "dhqp", "sigma", sigma, 0.03 * sigma, "± 3 %"))
    numbers = [n for n in range(1, 20) if "gn_qn" in results.get(f"T{n}", {})]
    if numbers:
        sigmas = {n: float(_value(results, n, "gn_qn", "sigma") or 0.0) for n in numbers}
        ratios = {n: xi(results, n, "gn_qn") or 0.0 for n in numbers}
        for label, values, most in (("Sigma", sigmas, 1.0), ("Xi", ratios, 1.03)):
            worst = max(values, key=lambda n: values[n])
            rows.append(_most(f"{label}, gn_qn, largest (T{worst})", values[worst], most))
    for name, number in (("gn_qn", 4), ("gn_qn", 6), ("gn_qn", 7), ("gn_qn", 8), ("newton", 5)):
        psi_found = _value(results, number, name, "psi")
        rows.append(_most(f"Psi, {name}, T{number}", psi_found, 220.0))
    if {"gn", "gn_qn"} <= set(results.get(_LONG, {})):
        gn, qn = results[_LONG]["gn"], results[_LONG]["gn_qn"]
        for label, value, most in (
            ("Sigma over that of gn", qn["sigma"] / gn["sigma"], 0.01),
            ("error integral over that of gn", qn["hand"] / gn["hand"], 1.02),
            ("CPU per step over that of gn", qn["cpu_us"] / gn["cpu_us"], 2.5),
            ("large box violated by [m]", qn["box_m"], 1e-4),
        ):
            rows.append(_most(f"T20, gn_qn: {label}", value, most))
    return table(["figure", "asked", "measured", "met"], rows)


def _near(
    results: Results, number: int, name: str, key: str, want: float, within: float, text: str
) -> list[str]:
    value = _value(results, number, name, key)
    met = None if value is None else abs(value - want) <= within
    return _checked(f"{key.title()}, {name}, T{number}", f"{want:g} {text}", value, met)


def _most(label: str, value: float | None, most: float) -> list[str]:
    met = None if value is None else value <= most
    return _checked(label, f"at most {most:g}", value, met)


def _checked(label: str, asked: str, value: float | None, met: bool | None) -> list[str]:
    if value is None:
        return [label, asked, "-", "-"]
    return [label, asked, f"{value:.4g}", "yes" if met else "**no**"]


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
