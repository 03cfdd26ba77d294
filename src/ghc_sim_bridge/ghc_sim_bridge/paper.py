"""`paper`: run the experiments of the GHC paper and write docs/results.md from their summaries."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from ghc_controller.errors import GhcError
from ghc_sim_bridge.interrupts import interruptible
from ghc_sim_bridge.paper_document import PaperResult, write_document
from ghc_sim_bridge.paper_runs import PAPER_RUNS, PaperRun, choose_runs


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; 0 = every run went well, 1 = at least one did not, 2 = wrong arguments."""
    options = _parser().parse_args(arguments)
    return interruptible("paper", partial(_run_all, options))


def _run_all(options: argparse.Namespace) -> int:
    try:
        chosen = () if options.document_only else choose_runs(options.only)
    except GhcError as error:
        print(f"paper: {error}", file=sys.stderr)
        return 2
    failed = [run.name for run in chosen if not _run(run, options.output)]
    results = _collect(options.output)
    path = write_document(results, options.docs)
    print(f"\n{path} written from {len(results)} of {len(PAPER_RUNS)} runs")
    if failed:
        print(f"paper: failed: {', '.join(failed)}", file=sys.stderr)
    return int(bool(failed))


def _run(run: PaperRun, output: Path) -> bool:
    """Make one run; whether it went well."""
    from ghc_sim_bridge.report import run_and_report, went_well  # late: documents need no ROS

    try:
        return went_well(run_and_report(run.plan(output)))
    except (GhcError, OSError) as error:
        print(f"paper: {run.name}: {error}", file=sys.stderr)
        return False


def _collect(output: Path) -> dict[str, PaperResult]:
    """Results of all paper runs that have been made, now or before, by name."""
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
        description="Run the GHC paper's experiments and write docs/results.md.",
        epilog=f"runs: {', '.join(run.name for run in PAPER_RUNS)}",
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
