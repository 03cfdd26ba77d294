"""Which code a result is of: a digest to compare, and a commit for readers."""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import ghc_controller
from benchmarks.compare.source_text import CORE_SUFFIXES, counted

_ROOT = Path(__file__).resolve().parents[1]
_SOURCES = (".py", *CORE_SUFFIXES)
# Rooms on which no figure of a study or comparison depends: nodes, hints, files of a new robot.
_APART = ("ros", "migration", "robot/first_files")


def sources() -> str:
    """Digest of the controller's code: results of different code do not stand in one table.

    The compiled core counts; docstrings, comments and the rooms of `_APART` do not.
    """
    package = Path(ghc_controller.__file__).parent
    apart = [package / room for room in _APART]
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*"), key=lambda path: path.relative_to(package).as_posix()):
        if path.suffix in _SOURCES and not any(path.is_relative_to(room) for room in apart):
            digest.update(counted(path))
    return digest.hexdigest()[:16]


def commit() -> str:
    """Commit that is checked out, as "28ff7aa (2026-11-26)"; empty outside of a repository.

    "with changes" follows where benchmarks or packages differ from it.
    """
    name = _git("show", "-s", "--format=%h (%cs)", "HEAD")
    changed = _git("status", "--porcelain", "--", "benchmarks", "src")
    return f"{name} with changes" if name and changed else name


def other_code(results: Mapping[str, Mapping[str, Any]]) -> str:
    """One sentence that names the results of other code than this, by commit; else nothing.

    Args:
        results: name -> stored result, with `sources` and `commit` where they were recorded.
    """
    present = sources()
    by_commit: dict[str, list[str]] = {}
    for name, result in results.items():
        if result.get("sources") != present:
            of = result.get("commit") or "a commit that was not recorded"
            by_commit.setdefault(of, []).append(f"`{name}`")
    if not by_commit:
        return ""
    groups = "; ".join(f"{', '.join(names)}: {of}" for of, names in sorted(by_commit.items()))
    return (
        f"These figures are of older code than the present one, of the commit named: {groups}. "
        "All others are of the present code."
    )


def _git(*arguments: str) -> str:
    try:
        done = subprocess.run(
            ["git", *arguments], cwd=_ROOT, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return ""
    return done.stdout.strip()
