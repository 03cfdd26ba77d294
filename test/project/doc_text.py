"""What the tests of the documents read: the files, their code blocks, links and hierarchies."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "README.md"
DOCUMENTS = sorted(
    [
        *ROOT.glob("*.md"),
        *(ROOT / "docs").rglob("*.md"),
        *(ROOT / "docker").glob("*.md"),
        *(ROOT / "security").glob("*.md"),
    ]
)
# Written by `make bench`: a link may be ahead of the file.
GENERATED = {ROOT / "docs" / "benchmarks.md"}
_BLOCK = re.compile(r"^```(\w*|\{[\w-]+\})\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)


class Block(NamedTuple):
    """A fenced block of a document."""

    language: str
    text: str


def blocks(document: Path, language: str = "") -> list[Block]:
    """Fenced blocks of a document, all or those of one language."""
    found = [Block(*match) for match in _BLOCK.findall(document.read_text(encoding="utf-8"))]
    return [block for block in found if not language or block.language == language]


def links(document: Path) -> list[str]:
    """Targets of links and pictures outside code."""
    return _LINK.findall(_BLOCK.sub("", document.read_text(encoding="utf-8")))


def anchors(document: Path) -> set[str]:
    """Anchors that a renderer gives the headings: lower case, hyphens, no punctuation."""
    headings = _HEADING.findall(_BLOCK.sub("", document.read_text(encoding="utf-8")))
    return {re.sub(r"[^\w\- ]", "", h.lower()).strip().replace(" ", "-") for h in headings}


def commands(document: Path) -> list[str]:
    """Lines of the bash blocks, without comments; one line where a command goes on."""
    text = "\n".join(block.text for block in blocks(document, "bash")).replace("\\\n", " ")
    lines = (line.split("  #")[0].strip() for line in text.splitlines())
    return [line for line in lines if line and not line.startswith("#")]
