"""Docstrings of the sources are plain text with backticks: what reStructuredText would misread."""

from __future__ import annotations

import re
from typing import Any

_CODE = re.compile(r"(``.*?``|`[^`]*`)")
_MARKS = re.compile(r"([|*])")
_FENCE = re.compile(r"^```(\w+)$")
_SECTION = re.compile(r"^(Args|Attributes|Raises|Returns|Yields|Example):$")
_ENTRY = re.compile(r"^ {4}\*{0,2}\w[\w, .*]*:( |$)")  # of a section: names, then a text


def escaped(line: str) -> str:
    """A line whose bars and stars are characters, outside code."""
    parts = _CODE.split(line)
    return "".join(part if i % 2 else _MARKS.sub(r"\\\1", part) for i, part in enumerate(parts))


def converted(lines: list[str]) -> list[str]:
    """Fenced blocks and indented formulas as literal blocks; the rest escaped.

    Below the first section (Args, Raises, ...) indentation belongs to the section.
    """
    result: list[str] = []
    fenced = literal = in_section = False
    for line in lines:
        fence = _FENCE.match(line)
        if fence and not fenced:
            fenced = True
            result += ["", f".. code-block:: {fence[1]}", ""]
        elif fenced:
            fenced = line != "```"
            result.append(f"   {line}" if fenced else "")
        elif in_section and _goes_on(line, result):
            result.append(f"    {escaped(line)}")
        else:
            in_section = in_section or bool(_SECTION.match(line))
            indented = line.startswith(" ") and not in_section
            if indented and not literal:
                result += ["", "::", ""]
            elif literal and not indented and line:
                result.append("")
            literal = indented or (literal and not line)
            result.append(line if literal else escaped(line))
    return result


def _goes_on(line: str, before: list[str]) -> bool:
    """Whether a line of a section with names belongs to the entry before it."""
    flush = line.startswith("    ") and not line.startswith("     ")
    return flush and not _ENTRY.match(line) and bool(before[-1].strip()) and _named(before)


def _named(before: list[str]) -> bool:
    """Whether the section that `before` ends in has names: the first line of it is an entry."""
    start = max(k for k, line in enumerate(before) if _SECTION.match(line))
    return len(before) > start + 1 and bool(_ENTRY.match(before[start + 1]))


def _process(_app: Any, _kind: str, _name: str, _obj: Any, _opts: Any, lines: list[str]) -> None:
    lines[:] = converted(lines)


def _plain(
    _app: Any, _kind: str, _name: str, _obj: Any, _opts: Any, arguments: str | None, result: Any
) -> tuple[str | None, Any]:
    """Signatures with the names of aliases: Sphinx writes a mark into unions of them."""
    mark = r"TypeAliasForwardRef\('(\w+)'\)"
    return tuple(re.sub(mark, r"\1", part) if part else part for part in (arguments, result))


def setup(app: Any) -> dict[str, bool]:
    """Connect with Sphinx; before napoleon, which makes marks of its own."""
    app.connect("autodoc-process-docstring", _process, priority=100)
    app.connect("autodoc-process-signature", _plain)
    return {"parallel_read_safe": True}
