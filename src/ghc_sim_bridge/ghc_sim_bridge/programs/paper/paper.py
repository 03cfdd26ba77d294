"""`paper`: run the experiments of paper and thesis, write docs/results.md from their summaries."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from ghc_controller.errors import GhcError
from ghc_sim_bridge.programs.generator_comparison import compare_generators
from ghc_sim_bridge.programs.paper.document import PaperResult, write_document
from ghc_sim_bridge.programs.paper.runs import (
    GENERATOR_PAIRS,
    PAPER_RUNS,
    STUDIES,
    PaperRun,
    choose_runs,
    wants_studies,
)
from ghc_sim_bridge.run.interrupts import interruptible


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = all runs succeeded, 1 = at least one failed, 2 = wrong arguments."""
    options = _parser().parse_args(arguments)
    return interruptible("paper", partial(_run_all, options))


def _run_all(options: argparse.Namespace) -> int:
    try:
        chosen = () if options.document_only else choose_runs(options.only)
    except GhcError as error:
        print(f"paper: {error}", file=sys.stderr)
        return 2
    failed = [run.name for run in chosen if not _run(run, options.output)]
    if not options.document_only and wants_studies(options.only) and not _study(options.docs):
        failed.append(STUDIES)
    results = _with_comparisons(_collect(options.output))
    path = write_document(results, options.docs)
    print(f"\n{path} written from {len(results)} of {len(PAPER_RUNS)} runs")
    if failed:
        print(f"paper: failed: {', '.join(failed)}", file=sys.stderr)
    return int(bool(failed))


def _run(run: PaperRun, output: Path) -> bool:
    """Execute one run; returns whether it succeeded."""
    from ghc_sim_bridge.programs.report import (  # imported late: documents need no ROS
        run_and_report,
        went_well,
    )

    try:
        return went_well(run_and_report(run.plan(output)))
    except (GhcError, OSError) as error:
        print(f"paper: {run.name}: {error}", file=sys.stderr)
        return False


def _study(docs: Path) -> bool:
    """Run the thesis' studies of the generators, which write their own document."""
    from ghc_sim_bridge.run.executables import find_executable

    try:
        command = [str(find_executable("ghc_sim_bridge", STUDIES)), "--docs", str(docs)]
        return subprocess.run(command, check=False).returncode == 0
    except (GhcError, OSError) as error:
        print(f"paper: {STUDIES}: {error}", file=sys.stderr)
        return False


def _with_comparisons(results: dict[str, PaperResult]) -> dict[str, PaperResult]:
    """Results, with the raw-bounds comparison added to runs with smoothed bounds."""
    for name, other in GENERATOR_PAIRS.items():
        if name in results and other in results:
            off, on = results[other], results[name]
            data = compare_generators(off.plan, on.plan, (off.summary, on.summary))
            results[name] = PaperResult(on.plan, {**on.summary, "comparison": data})
    return results


def _collect(output: Path) -> dict[str, PaperResult]:
    """Results of all finished paper runs, current and earlier, by name."""
    results = {}
    for run in PAPER_RUNS:
        plan = run.plan(output)
        summary = plan.folder / "summary.json"
        if summary.is_file():
            content = json.loads(summary.read_text(encoding="utf-8"))
            results[run.name] = PaperResult(plan, content)
    return results


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="paper",
        description="Run the experiments of the GHC paper and the thesis, write docs/results.md.",
        epilog=f"runs: {', '.join(run.name for run in PAPER_RUNS)}, {STUDIES}",
    )
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="NAME",
        help="only this run or scenario; may be repeated",
    )
    parser.add_argument(
        "--document-only",
        action="store_true",
        help="write the document from the results that are there",
    )
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("results"),
        metavar="DIR",
        help="root of all results (default: results)",
    )
    parser.add_argument(
        "--docs",
        type=Path,
        default=Path("docs"),
        metavar="DIR",
        help="where results.md and figures/ go (default: docs)",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
