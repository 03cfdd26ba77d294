"""`make bench`: tables on the terminal, bench.json and a plot below --output.

Nodes inherit the environment; in this process linear algebra is kept to one thread, since on
matrices this small a second one only waits.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = everything measured, 1 = something is missing, reported in one line."""
    options = _parser().parse_args(arguments)
    for name in _THREADS:  # before NumPy is imported
        os.environ.setdefault(name, "1")
    import ghc_controller as ghc
    from benchmarks.loops.realtime_bench import run_realtime
    from benchmarks.peers.session import run_peers
    from benchmarks.peers.tails import run_tails
    from benchmarks.steps.session import run_session
    from ghc_controller.ros.stop_signals import interrupt_on_stop_signals
    from tools.workspace.errors import SetupError

    interrupt_on_stop_signals()
    try:
        if options.only == "peers":
            run_peers(ROOT, options.output, quick=options.quick, write_docs=options.write_docs)
        elif options.only == "tails":
            run_tails(ROOT, options.output, quick=options.quick)
        elif options.only == "realtime":
            run_realtime(options.output, quick=options.quick)
        else:
            run_session(options, ROOT)
    except (ghc.GhcError, SetupError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("bench: interrupted; nothing was written", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="bench", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a short run, to see that it works")
    parser.add_argument(
        "--only",
        choices=("step", "standing", "mpc", "loop", "peers", "tails", "realtime"),
        help="one of the benchmarks; peers (tsid and placo, installed by it), tails (1e5 steps "
        "of a case) and realtime (beside a bare loop) are part of no other",
    )
    parser.add_argument("--robot", choices=("kuka_lwr", "icub"), help="steps of one robot only")
    parser.add_argument("--output", type=Path, default=Path("results/bench"), metavar="DIR")
    parser.add_argument(
        "--write-docs",
        action="store_true",
        help="write docs/benchmarks.md (docs/peers.md) and its figure too",
    )
    return parser


if __name__ == "__main__":
    sys.path[0] = str(ROOT)  # instead of this folder: its modules are those of a package
    sys.exit(main())
