"""docs/mistakes.md: every mistake of the list is made, and its message names the cause."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.mistakes.mistake import Mistake
from benchmarks.mistakes.page import MISTAKES, PAGE, row

TEXT = PAGE.read_text(encoding="utf-8")


def test_all_of_them_are_on_the_page() -> None:
    assert [mistake.number for mistake in MISTAKES] == list(range(1, 43))
    assert sum(line.startswith("| ") for line in TEXT.splitlines()) == len(MISTAKES) + 2


def _check(mistake: Mistake, folder: Path) -> None:
    message = mistake.message(folder)
    assert mistake.missing(message) == [], message
    cells = row(mistake, message)
    assert f"| {' | '.join(cells)} |" in TEXT, "run: python -m benchmarks.mistakes.page"


@pytest.mark.parametrize(
    "mistake", [m for m in MISTAKES if not m.processes], ids=lambda m: str(m.number)
)
def test_a_mistake_gets_its_message(mistake: Mistake, tmp_path: Path) -> None:
    _check(mistake, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize(
    "mistake", [m for m in MISTAKES if m.processes], ids=lambda m: str(m.number)
)
def test_a_mistake_at_the_command_line_gets_its_message(mistake: Mistake, tmp_path: Path) -> None:
    _check(mistake, tmp_path)
