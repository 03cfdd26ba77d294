"""`make test` runs tests that failed once more, alone; what fails alone fails."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# Fails in its first run, passes in the second, which finds the file of the first.
ONCE = """
from pathlib import Path
def test_once(): mark = Path("mark"); first = not mark.exists(); mark.touch(); assert not first
"""
ALWAYS = "def test_always(): assert False\n"
MANY = "import pytest\n@pytest.mark.parametrize('n', range(6))\ndef test_n(n): assert False\n"
GOOD = "def test_good(): pass\n"


def _run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    (folder / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "tools.run_tests", "-p", "no:cacheprovider", *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    ("text", "code", "runs"), [(GOOD, 0, 1), (ONCE, 0, 2), (ALWAYS, 1, 2), (MANY, 1, 1)]
)
def test_few_failures_run_once_more(tmp_path: Path, text: str, code: int, runs: int) -> None:
    """One that passes alone is named; one that fails alone, or one of many, fails the run."""
    (tmp_path / "test_it.py").write_text(text, encoding="utf-8")
    done = _run(tmp_path, "-n", "1")
    assert done.returncode == code, done.stdout + done.stderr
    assert done.stdout.count("test session starts") == runs
    assert ("they depend on the machine" in done.stdout) == (text == ONCE)
