"""First section of the page: the cases in which `cascade` is not ahead."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from benchmarks.compare.case import Case
from benchmarks.compare.cases import CASES
from benchmarks.compare.method import REFERENCE
from benchmarks.compare.pages.assessment import Assessment, Loss, judge
from benchmarks.compare.pages.causes import cause, explained
from benchmarks.compare.store import Results
from ghc_sim_bridge.programs.markdown import number, table

_QP_PER_LEVEL = ("hqp", "rhp_hqp", "hqp_transition")
_NAMES = ", ".join(f"`{name}`" for name in _QP_PER_LEVEL)

_WHY_QPS = (
    "- **QPs.** `cascade` solves one for each level and order whose optimum meets a bound: every "
    "level is exact there, which one QP for all levels is not (*loss of any level at a bound*). "
    "While two orders are mixed it solves both, as `hqp_transition` does; `hqp` and `rhp_hqp` "
    "solve one. At w = 0.01 the runs differ (c). With ten tasks `hqp` stops at the level that "
    "uses the last joint, where a soft null space keeps a rest. QPs of `cascade` start from the "
    "active set before; in every case `hqp`, `rhp_hqp` and `hqp_transition` need 1.5 to 12 times "
    "its operations."
)


class Judged(NamedTuple):
    """The assessments of one case by method."""

    case: Case
    assessments: dict[str, Assessment]


def judged(results: Results) -> Iterator[Judged]:
    """Assessments of every case that the reference has a result of."""
    for name, by_method in results.items():
        if REFERENCE not in by_method:
            continue
        case = CASES[name]
        found = {
            method: assessment
            for method, result in by_method.items()
            if method != REFERENCE
            and (assessment := judge(case, by_method[REFERENCE], result)) is not None
        }
        if found:
            yield Judged(case, found)


def first_screen(results: Results) -> str:
    """A sentence with counts, then the table of exceptions."""
    cases = list(judged(results))
    accurate = [each for each in cases if not any(v.plain for v in each.assessments.values())]
    cheap = [each for each in cases if not any(v.more_qps for v in each.assessments.values())]
    pairs = [assessment for each in cases for assessment in each.assessments.values()]
    good = sum(not assessment.plain for assessment in pairs)
    fewer = sum(not assessment.more_qps for assessment in pairs)
    levels = [
        assessment
        for each in cases
        for method, assessment in each.assessments.items()
        if method in _QP_PER_LEVEL
    ]
    fewer_there = sum(not assessment.more_qps for assessment in levels)
    lines = [
        [each.case.title, _less_accurate(each), _more_qps(each)]
        for each in cases
        if each not in accurate or each not in cheap
    ]
    letters = [
        cause(each.case.name, method)
        for each in cases
        for method, assessment in each.assessments.items()
        if assessment.plain
    ]
    head = [
        "case",
        f"less accurate than (task, phase/level: `{REFERENCE}` / other)",
        "more QPs than (per step)",
    ]
    return (
        f"`{REFERENCE}` is at least as accurate as the other formulation in {good} of "
        f"{len(pairs)} pairs of case and formulation, level by level, and solves no more QPs in "
        f"{fewer}. It is so against every other one in {len(accurate)} and {len(cheap)} of "
        f"{len(cases)} cases. Against formulations with a QP per level ({_NAMES}) it solves no "
        f"more in {fewer_there} of {len(levels)} pairs; the others solve at most one per step, "
        f"whatever they reach with it. The exceptions, with the letter of their cause:\n\n"
        f"{table(head, lines)}\n\n{explained(letters)}\n{_WHY_QPS}"
    )


def _less_accurate(each: Judged) -> str:
    """The worst task for each method; methods with the same figures together."""
    found: dict[str, list[str]] = {}
    for method, assessment in each.assessments.items():
        if assessment.plain:
            text = f"{_shown(worst(assessment.plain))}; {cause(each.case.name, method)}"
            found.setdefault(text, []).append(method)
    return "; ".join(f"{', '.join(names)} ({text})" for text, names in found.items()) or "–"


def _more_qps(each: Judged) -> str:
    """Methods by their QPs; the reference has the same number in each."""
    found: dict[str, list[str]] = {}
    own = ""
    for method, assessment in each.assessments.items():
        if assessment.more_qps:
            own = number(assessment.qps)
            found.setdefault(number(assessment.other_qps), []).append(method)
    text = "; ".join(f"{', '.join(names)} ({qps})" for qps, names in found.items())
    return f"{own} against {text}" if text else "–"


def worst(losses: tuple[Loss, ...]) -> Loss:
    """The loss of largest ratio."""
    return max(losses, key=lambda loss: loss.error / max(loss.other, 1e-5))


def _shown(loss: Loss) -> str:
    values = f"{number(loss.error, 3)} / {number(loss.other, 3)}"
    return f"{loss.task}, {loss.phase}/{loss.level}: {values}"


def given_up(results: Results) -> str:
    """Tasks of a lower level on which another method is ahead after it lost a level above."""
    lines = []
    for each in judged(results):
        for method, assessment in each.assessments.items():
            losses = tuple(loss for loss in assessment.losses if loss.given_up)
            if losses:
                lines.append([each.case.title, method, str(len(losses)), _shown(worst(losses))])
    head = ["case", "formulation", "tasks", f"the largest (`{REFERENCE}` / other)"]
    return table(head, lines)
