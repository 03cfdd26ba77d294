"""`make soak`: memory of each generator node over ten minutes of simulated time.

Table on the terminal, soak.json and a plot below --output. Each node runs as a process of its own
and is asked over DDS for plan after plan, as fast as it answers.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main(arguments: Sequence[str] | None = None) -> int:
    """0 = the memory of both nodes stays, 1 = it grows, or something failed."""
    options = _parser().parse_args(arguments)
    import ghc_controller as ghc
    from benchmarks.soak.session import run_soak
    from ghc_controller.ros.stop_signals import interrupt_on_stop_signals

    interrupt_on_stop_signals()
    try:
        return 0 if run_soak(options, ROOT) else 1
    except ghc.GhcError as error:
        print(f"soak: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("soak: interrupted; nothing was written", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="soak", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a short run, to see that it works")
    parser.add_argument("--output", type=Path, default=Path("results/soak"), metavar="DIR")
    parser.add_argument(
        "--write-docs", action="store_true", help="write the section of docs/benchmarks.md too"
    )
    return parser


if __name__ == "__main__":
    sys.path[0] = str(ROOT)  # instead of this folder: its modules are those of a package
    sys.exit(main())
