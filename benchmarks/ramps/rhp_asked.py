"""What is asked of RHP-HQP and of `cascade` beside it, against a stored result of the study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from ghc_sim_bridge.programs.markdown import number, table

Line = tuple[str, str, str, bool]  # figure, asked, measured, met
_LOW, _HIGH = "0.0001", "0.01"  # w
_ALL_BUT_GHC = ("rhp_hqp", "hqp_transition", "hqp", "cascade")


def asked_table(result: Mapping[str, Any]) -> str:
    """A line per figure; nothing unless all formulations are in the result."""
    if not {*_ALL_BUT_GHC, "ghc"} <= set(result["formulations"]):
        return ""
    rows = [[*line[:3], "yes" if line[3] else "no"] for line in _lines(result["formulations"])]
    return table(["figure", "asked", "measured", "met"], rows)


def damped_share(found: Mapping[str, Any], w: str) -> float | None:
    """Timed ramp: integral of `cascade` over that of `hqp_transition`, both damped towards -kd v.

    None where a stored result has none.
    """
    runs = [found[name].get("damped_ramp") for name in ("cascade", "hqp_transition")]
    if None in runs:
        return None
    mine, other = (run[w]["integral_mm_s"] for run in runs)
    return float(mine / other)


def _lines(found: Mapping[str, Any]) -> Iterator[Line]:
    rhp = found["rhp_hqp"]
    apart = rhp["apart_from_hqp"]
    yield "`rhp_hqp` from `hqp` at strict orders, relative", "1e-8", number(apart), apart <= 1e-8
    jump = rhp["random"][_HIGH]["swap_jump"]
    yield "swap of one Jacobian, w = 0.01: jump at the ends", "1e-6", number(jump), jump <= 1e-6
    constant = rhp["constant_weights"]["swap_jump"]
    text = "the same with constant weights"
    yield text, "more than 0.3", number(constant), constant > 0.3
    for w, least, most in ((_HIGH, 5.8, 7.8), (_LOW, 47.0, 53.0)):
        step = 100.0 * rhp["random"][w]["removal_step"]
        text = f"removal over the posture, `rhp_hqp`, w = {w}: step"
        yield text, f"{least:g} to {most:g} %", f"{number(step)} %", least <= step <= most
    steps = [
        100.0 * found[name]["random"][w]["removal_step"]
        for name in ("hqp_transition", "cascade")
        for w in (_LOW, _HIGH)
    ]
    text = "the same, `hqp_transition` and `cascade`"
    yield text, "at most 1.1 %", f"{number(max(steps))} %", max(steps) <= 1.1
    hand = {name: f["cases"][_LOW]["constant"]["max_mm"] for name, f in found.items()}
    kept = max(hand[name] for name in ("rhp_hqp", "hqp", "cascade"))
    text = "case 1, w = 1e-4: hand with `rhp_hqp`, `hqp`, `cascade`"
    yield text, "below 0.1 mm", f"{number(kept)} mm", kept < 0.1
    ratio = hand["ghc"] / kept
    yield "the same, `ghc` over the largest of these", "at least 30", number(ratio), ratio >= 30.0
    for w in (_LOW, _HIGH):
        integrals = [
            found[name]["cases"][w]["ramp"]["integral_mm_s"]
            for name in ("cascade", "hqp_transition")
        ]
        share = integrals[0] / integrals[1]
        text = f"case 2, timed ramp, w = {w}: integral of `cascade` over `hqp_transition`"
        yield text, "at most 1.05", number(share, 3), share <= 1.05
    for w in (_LOW, _HIGH):
        if share := damped_share(found, w):
            text = f"the same, w = {w}, both with the default `velocity_damping`"
            yield text, "at most 1.05", number(share, 3), share <= 1.05
    runs = [found[name]["cases"][w]["reactive"] for name in _ALL_BUT_GHC for w in (_LOW, _HIGH)]
    end = max(run["end_mm"] for run in runs)
    turn = max(run["turn_max_rad"] for run in runs)
    yield "case 3, all but `ghc`: hand at the end", "below 1 mm", f"{number(end)} mm", end < 1.0
    text = "the same, orientation throughout"
    yield text, "below 5e-3 rad", f"{number(turn)} rad", turn < 5e-3
