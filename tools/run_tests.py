"""What `make test` runs: pytest, then the tests that failed once more, one after the other.

Tests of nodes are processes that talk in real time, beside other tests and whatever else the
machine does. A test that fails there and passes alone depends on the machine: it is named at the
end, to be mended. What fails alone as well fails the run, and so do more than a few failures.

    python -m tools.run_tests -n 2 --dist loadfile
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence

import pytest

FEW = 5  # [-] failed tests; more of them are no accident of the machine


class FailedTests:
    """Plugin of pytest: the node ids of tests of which set-up, call or tear-down failed."""

    def __init__(self) -> None:
        """Start with none."""
        self.names: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a failure, also one of a worker process."""
        if report.failed and report.nodeid not in self.names:
            self.names.append(report.nodeid)


def main(arguments: Sequence[str]) -> int:
    """Run the tests with these arguments of pytest; exit code of pytest's last run."""
    failed = FailedTests()
    code = int(pytest.main([*arguments], plugins=[failed]))
    if code != pytest.ExitCode.TESTS_FAILED or not 0 < len(failed.names) <= FEW:
        return code
    _say("failed, and run once more, alone", failed.names)
    again = [sys.executable, "-m", "pytest", "-n", "0", *failed.names]
    code = subprocess.run(again, check=False).returncode
    if code == 0:
        _say("passed alone: they depend on the machine", failed.names)
    return code


def _say(what: str, names: Sequence[str]) -> None:
    print(f"\nmake test: {len(names)} {what}:", *names, sep="\n  ", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
