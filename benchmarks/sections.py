"""Sections of a document that are written by different commands."""

from __future__ import annotations

import re
from dataclasses import dataclass

_END = "<!-- end -->"


@dataclass(frozen=True, slots=True)
class Section:
    """One section, between two comments."""

    mark: str  # what the comment before it says: which command writes it
    before: str = ""  # heading before which it is put where the document has none yet

    @property
    def _begin(self) -> str:
        return f"<!-- {self.mark} -->"

    @property
    def _pattern(self) -> re.Pattern[str]:
        return re.compile(f"{re.escape(self._begin)}\n(.*?){re.escape(_END)}\n", re.DOTALL)

    def put(self, document: str, body: str) -> str:
        """The document with the body of this section replaced."""
        section = f"{self._begin}\n{body.strip()}\n\n{_END}\n"
        if self._pattern.search(document):
            return self._pattern.sub(lambda _: section, document, count=1)
        head, found, tail = document.partition(self.before) if self.before else (document, "", "")
        return head.rstrip() + f"\n\n{section}" + (f"\n{found}{tail}" if found else "")

    def keep(self, document: str, before: str) -> str:
        """The document with the body of the previous document, if it has one."""
        kept = self._pattern.search(before)
        return document if kept is None else self.put(document, kept.group(1))
