"""The studies: one module each, found by being here or in a folder below.

A study has NAME, TITLE, FORMULATIONS (those it is about), `run(quick, formulations)`, which
returns {"facts": sizes and seeds, "formulations": {name: figures}}, all JSON values, and
`table(result)`, Markdown with a sentence that says what the figures are. One with a figure has
FIGURE and CAPTION as well, and `plot(result, path)`; one with a page of its own beside
study.md has PAGE and `page(result)`.
"""

from __future__ import annotations

import importlib
import pkgutil
from pathlib import Path
from typing import Any, Protocol, runtime_checkable


class Study(Protocol):
    """Interface of a study module."""

    NAME: str
    TITLE: str
    FORMULATIONS: tuple[str, ...]

    def run(self, quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
        """Measure; a quick run is very small."""

    def table(self, result: dict[str, Any]) -> str:
        """Markdown of a stored result."""


@runtime_checkable
class StudyWithFigure(Study, Protocol):
    """Interface of a study module with a figure."""

    FIGURE: str  # file name
    CAPTION: str

    def plot(self, result: dict[str, Any], path: Path) -> None:
        """Draw a stored result."""


@runtime_checkable
class StudyWithPage(Study, Protocol):
    """Interface of a study module with a separate page."""

    PAGE: str  # file name

    def page(self, result: dict[str, Any]) -> str:
        """Markdown of the page of a stored result."""


def load_studies() -> dict[str, Study]:
    """All studies by name, in alphabetical order."""
    modules = (
        importlib.import_module(entry.name)
        for entry in pkgutil.walk_packages(__path__, f"{__name__}.")
        if not entry.ispkg
    )
    return {module.NAME: module for module in modules}
