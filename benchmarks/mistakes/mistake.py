"""A mistake of a user: what it is, how it is done, and what its message has to say."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import ghc_controller as ghc

Doing = Callable[[Path], str]  # does the mistake in an empty folder; returns the message


@dataclass(frozen=True, slots=True)
class Mistake:
    """One row of docs/mistakes.md.

    Attributes:
        number: of the list that users_mistakes of the first trial began, 1 to 42.
        what: the mistake, in Markdown.
        words: that the message must contain: the cause, what was given, expected, and exists.
        do: does it; returns the message, "" for none.
        processes: whether nodes are started for it.
    """

    number: int
    what: str
    words: tuple[str, ...]
    do: Doing
    processes: bool = False

    def message(self, folder: Path) -> str:
        """Do the mistake; the message without the paths of this machine, "" if there is none."""
        folder.mkdir(parents=True, exist_ok=True)
        return without_places(self.do(folder), folder)

    def missing(self, message: str) -> list[str]:
        """Words that a message lacks."""
        return [word for word in self.words if word not in message]


def refused(action: Callable[[], object]) -> str:
    """The message of the error that `action` raises, "" if it succeeds."""
    try:
        action()
    except ghc.GhcError as error:
        return str(error)
    return ""


def without_places(text: str, folder: Path) -> str:
    """A message with paths relative to the folder, and without what differs between runs."""
    text = text.replace(f"{folder.resolve()}/", "").replace(f"{folder}/", "")
    text = re.sub(r"(/[\w.@+-]+)+/(?=[\w.-]+\.(yaml|urdf|xml|xacro))", "", text)
    text = re.sub(r"-[0-9a-f]{8}\b", "-1f3a5c7e", text)  # made of a path
    text = re.sub(r"^\[[A-Z]+\] \[[\d.]+\] \[[\w./]+\]: ", "", text, flags=re.MULTILINE)
    return " ".join(text.split())
