"""`studies`: run the thesis' studies of both generators and write docs/mpc_studies.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from ghc_sim_bridge.programs.studies.document import write_document
from ghc_sim_bridge.programs.studies.figures import write_figures
from ghc_sim_bridge.programs.studies.plan_of_studies import all_workers, run_studies


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = written."""
    options = _parser().parse_args(arguments)
    studies = run_studies(options.workers, not options.no_timing)
    write_figures(studies, options.docs / "figures")
    path = write_document(studies, options.docs)
    print(f"{path} written")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="studies",
        description="Run the thesis' studies without a robot and write docs/mpc_studies.md.",
    )
    parser.add_argument(
        "--docs",
        type=Path,
        default=Path("docs"),
        metavar="DIR",
        help="where mpc_studies.md and figures/ go (default: docs)",
    )
    parser.add_argument(
        "--workers",
        type=int,
        default=all_workers(),
        metavar="N",
        help="processes at a time (default: one a core)",
    )
    parser.add_argument("--no-timing", action="store_true", help="leave the tick times out")
    return parser


if __name__ == "__main__":
    sys.exit(main())
