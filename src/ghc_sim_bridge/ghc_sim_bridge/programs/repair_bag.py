"""`repair_bag`: repair a truncated recording, after a killed recorder or a full disk."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from ghc_controller.errors import GhcError
from ghc_sim_bridge.recorder.repair import repair_bag


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code: 0 = repaired, 2 = wrong arguments or files."""
    parser = argparse.ArgumentParser(
        prog="repair_bag", description="Rewrite a rosbag2 folder up to where it was cut."
    )
    parser.add_argument("folder", type=Path, help="such as results/priority_switching/recording")
    folder = parser.parse_args(arguments).folder
    try:
        extent = repair_bag(folder)
    except (GhcError, OSError) as error:
        print(f"repair_bag: {error}", file=sys.stderr)
        return 2
    span = f"t = {extent.start_ns * 1e-9:.3f} s to {extent.end_ns * 1e-9:.3f} s"
    print(f"{folder}: {extent.messages} messages, {span}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
