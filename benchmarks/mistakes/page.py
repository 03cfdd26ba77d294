"""docs/mistakes.md from real runs: `python -m benchmarks.mistakes.page`."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from pathlib import Path

from benchmarks.mistakes.files import FILES
from benchmarks.mistakes.mistake import Mistake
from benchmarks.mistakes.processes import PROCESSES
from benchmarks.mistakes.requests import REQUESTS
from ghc_sim_bridge.programs.markdown import table

PAGE = Path(__file__).resolve().parents[2] / "docs" / "mistakes.md"
MISTAKES: tuple[Mistake, ...] = tuple(
    sorted((*FILES, *REQUESTS, *PROCESSES), key=lambda mistake: mistake.number)
)
_HEAD = (
    "# Mistakes and their messages\n\n"
    "Forty-two plausible mistakes, each made for real by `python -m benchmarks.mistakes.page`, "
    "and the message that it gets. The robot is the arm of [own_robot.md](own_robot.md) or the "
    "KUKA of the demo; several messages in one row are separated by a slash. Tests make each "
    "mistake again, compare the message with this page, and check that it names the cause, what "
    "was given, what was expected and which names exist. By message: "
    "[troubleshooting.md](troubleshooting.md).\n\n"
)


_LONG = re.compile(r"((?:known|it has): (?:\w+, ){6})(?:\w+, ){3,}\w+")


def row(mistake: Mistake, message: str) -> list[str]:
    """Cells of a mistake; of a long list of names the first ones."""
    shown = _LONG.sub(r"\1…", message).replace("|", "\\|").replace("`", "'")
    return [str(mistake.number), mistake.what, f"`{shown}`"]


def rendered(messages: Mapping[int, str]) -> str:
    """The page, of messages by number."""
    rows = [row(mistake, messages[mistake.number]) for mistake in MISTAKES]
    return _HEAD + table(["", "mistake", "message"], rows) + "\n"


def main() -> None:
    """Make all mistakes and write the page."""
    with tempfile.TemporaryDirectory() as folder:
        messages = {m.number: m.message(Path(folder) / str(m.number)) for m in MISTAKES}
    for mistake in MISTAKES:
        message = messages[mistake.number]
        print(f"{mistake.number}: lacks {mistake.missing(message) or 'nothing'}: {message}")
    PAGE.write_text(rendered(messages), encoding="utf-8")


if __name__ == "__main__":
    main()
