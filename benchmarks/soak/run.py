"""`make soak`: memory of each generator node over ten minutes of simulated time.

With ARGS="--stack" the whole stack for an hour instead: see stack.py.

Table on the terminal, soak.json and a plot below --output. Each node runs as a process of its own
and is asked over DDS for plan after plan, as fast as it answers.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main(arguments: Sequence[str] | None = None) -> int:
    """0 = the memory of both nodes stays, 1 = it grows, or something failed."""
    options = _parser().parse_args(arguments)
    import ghc_controller as ghc
    from benchmarks.soak.session import run_soak
    from benchmarks.soak.stack import run_stack
    from ghc_controller.ros.stop_signals import interrupt_on_stop_signals

    interrupt_on_stop_signals()
    try:
        soaked = run_stack(options) if options.stack else run_soak(options, ROOT)
        return 0 if soaked else 1
    except ghc.GhcError as error:
        print(f"soak: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("soak: interrupted; nothing was written", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="soak", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a short run, to see that it works")
    parser.add_argument(
        "--stack", action="store_true", help="the whole stack under random inputs and kills"
    )
    parser.add_argument("--hours", type=float, default=1.0, help="of simulated time, with --stack")
    parser.add_argument(
        "--warm-up", type=float, default=300.0, help="[s] of a process, which do not count"
    )
    parser.add_argument(
        "--wall-minutes", type=float, default=math.inf, metavar="MIN",
        help="with --stack: judge what was reached by then",
    )  # fmt: skip
    parser.add_argument("--output", type=Path, default=Path("results/soak"), metavar="DIR")
    parser.add_argument(
        "--write-docs",
        action="store_true",
        help="write the section of docs/benchmarks.md too, or that of docs/reliability.md",
    )
    return parser


if __name__ == "__main__":
    sys.path[0] = str(ROOT)  # instead of this folder: its modules are those of a package
    sys.exit(main())
