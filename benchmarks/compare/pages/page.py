"""The page docs/comparison.md: `comparison.md` beside this file with its tables from results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks.compare.cases import CASES
from benchmarks.compare.jobs import Job, all_jobs, job_digest
from benchmarks.compare.pages import papers
from benchmarks.compare.pages.case_tables import case_tables
from benchmarks.compare.pages.first_screen import first_screen, given_up
from benchmarks.compare.pages.overview import plot_overview
from benchmarks.compare.store import Results
from ghc_sim_bridge.programs.markdown import picture

FIGURE = "comparison.png"
_CAPTION = (
    "Every formulation in every case. A dot is a case; one that is missing was rejected, or the "
    "figure does not apply to it. Gray lines: equal to `cascade`, and an even ramp."
)
_TEMPLATE = Path(__file__).with_name("comparison.md")


def write_page(results: Results, folder: Path) -> Path:
    """Write <folder>.md and figures/comparison.png beside it; the path of the page."""
    plot_overview(results, folder.parent / "figures" / FIGURE)
    target = folder.with_suffix(".md")
    target.write_text(page(results), encoding="utf-8")
    return target


def page(results: Results) -> str:
    """Markdown of the page."""
    text = _TEMPLATE.read_text(encoding="utf-8")
    for name, part in _PARTS.items():
        text = text.replace(f"<!-- {name} -->", part(results))
    return text


def missing(results: Results) -> str:
    """Sentences on results that are missing, or are of older code; nothing if all are present."""
    jobs = list(all_jobs())
    absent = [job for job in jobs if job.method not in results.get(job.case, {})]
    older = [
        job
        for job in jobs
        if job not in absent and results[job.case][job.method]["sources"] != job_digest(job)
    ]
    parts = []
    if absent:
        parts.append(f"{len(absent)} of {len(jobs)} results are missing: {_named(absent)}.")
    if older:
        shown = len(jobs) - len(absent)
        every = len(older) == shown
        commits = {results[job.case][job.method].get("commit") or "not recorded" for job in older}
        parts.append(
            f"{'All' if every else f'{len(older)} of the'} {shown} results shown are of older "
            f"code than the present one, commit {', '.join(sorted(commits))}"
            + ("." if every else f": {_named(older)}.")
        )
    return " ".join(parts)


def _named(jobs: Sequence[Job]) -> str:
    by_case: dict[str, list[str]] = {}
    for case, method, _ in jobs:
        by_case.setdefault(case, []).append(method)
    return "; ".join(
        f"{case} ({', '.join(methods) if len(methods) < 8 else 'most'})"
        for case, methods in by_case.items()
    )


def _cases(results: Results) -> str:
    return "\n\n".join(
        f"### {CASES[name].title}\n\n`{name}`\n\n{case_tables(CASES[name], by_method)}"
        for name, by_method in results.items()
    )


_PARTS: dict[str, Callable[[Results], str]] = {
    "missing": missing,
    "first_screen": first_screen,
    "figure": lambda results: picture(FIGURE, _CAPTION),  # noqa: ARG005
    "given_up": given_up,
    "cases": _cases,
    "ghc": papers.ghc_table,
    "rhp": papers.rhp_table,
    "rhp_cost": papers.rhp_cost_table,
    "lunge": papers.lunge_table,
    "cost": lambda results: papers.cost_table(),  # noqa: ARG005
}
