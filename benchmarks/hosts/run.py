"""`make hosts`: three hosts over a bad network, docs/reliability.md; ARGS=--quick: two rows.

Ends with 0 when every row holds, or where namespaces are not allowed, which it then says.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.hosts.namespaces import UNSHARE, namespaces_work, network
from benchmarks.hosts.session import HOSTS

ROOT = Path(__file__).resolve().parents[2]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run, print, write hosts.json below --output and the section of the document."""
    parser = argparse.ArgumentParser(prog="make hosts", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two rows; the document stays")
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "hosts")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    if options.inside:
        return _inside(options.output, options.quick)
    reason = namespaces_work()
    if reason:
        print(f"hosts: skipped, network namespaces are not allowed here: {reason}")
        return 0
    words = ["--inside", "--output", str(options.output), *(["--quick"] if options.quick else [])]
    command = [*UNSHARE, sys.executable, "-m", "benchmarks.hosts.run", *words]
    return subprocess.run(command).returncode


def _inside(folder: Path, quick: bool) -> int:
    """The same in a namespace of its own, where hosts can be made."""
    path = folder / "hosts.json"
    path.unlink(missing_ok=True)
    with network(HOSTS, folder) as net:
        words = [json.dumps(dict(net.enter)), str(net.control), str(folder), "quick" * quick]
        command = [sys.executable, "-m", "benchmarks.hosts.campaign", *words]
        code = subprocess.run([*net.enter["operator"], *command]).returncode
    if code or not path.exists():
        return code or 1
    report = json.loads(path.read_text(encoding="utf-8"))
    if not quick:
        from benchmarks.hosts.page import write_section

        write_section(report, os.cpu_count() or 1, ROOT / "docs" / "reliability.md")
    held = sum(not row["broken"] for row in report["rows"])
    for row in report["rows"]:
        print(f"{row['row']:28} {'holds' if not row['broken'] else row['broken']}")
    return int(held != len(report["rows"]))


if __name__ == "__main__":
    sys.exit(main())
