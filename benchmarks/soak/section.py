"""The part of docs/benchmarks.md that `make soak` writes and `make bench` leaves as it is."""

from __future__ import annotations

import re

_BEGIN, _END = "<!-- soak: written by `make soak ARGS=--write-docs` -->", "<!-- end -->"
_SECTION = re.compile(f"{re.escape(_BEGIN)}\n.*?{re.escape(_END)}\n", re.DOTALL)
_NEXT = "## What to keep in mind"  # the section is put before it


def with_soak_section(document: str, body: str) -> str:
    """The document with this as its soak section, in place of the one that it has."""
    section = f"{_BEGIN}\n{body.strip()}\n\n{_END}\n"
    if _SECTION.search(document):
        return _SECTION.sub(lambda _: section, document, count=1)
    head, found, tail = document.partition(_NEXT)
    return head.rstrip() + f"\n\n{section}" + (f"\n{found}{tail}" if found else "")


def keep_soak_section(document: str, before: str) -> str:
    """The document with the soak section of the one before, if that has one."""
    kept = _SECTION.search(before)
    if kept is None:
        return document
    body = kept.group().removeprefix(f"{_BEGIN}\n").removesuffix(f"{_END}\n")
    return with_soak_section(document, body)
