"""Stamps: a hash of a step's inputs, written beside its outputs when the step has ended."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path


def key_of(files: Iterable[Path], *facts: object) -> str:
    """Hash of names and contents of files, and of facts such as a version."""
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(f"{path.name}\0".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    for fact in facts:
        digest.update(f"{fact}\0".encode())
    return digest.hexdigest()


def files_below(folder: Path) -> list[Path]:
    """Every file below a folder that is a source and not a by-product."""
    return [
        path
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and path.suffix != ".pyc"
    ]


class Stamp:
    """State of one step: never run, begun with some inputs, or done with some inputs."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def exists(self) -> bool:
        """Whether the step was ever run."""
        return self._path.is_file()

    def is_done(self, key: str) -> bool:
        """Whether the step ended with these inputs."""
        return self._read() == ["done", key]

    def is_begun(self, key: str) -> bool:
        """Whether the step was started, perhaps ended, with these inputs."""
        return self._read()[1:] == [key]

    def begin(self, key: str) -> None:
        """Note that the outputs are from now on those of `key`, and not complete."""
        self._write("begun", key)

    def done(self, key: str) -> None:
        """Note that the outputs are complete."""
        self._write("done", key)

    def _read(self) -> list[str]:
        try:
            return self._path.read_text(encoding="utf-8").split()
        except OSError:
            return []

    def _write(self, state: str, key: str) -> None:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        fresh = self._path.with_suffix(".new")
        fresh.write_text(f"{state} {key}\n", encoding="utf-8")
        fresh.replace(self._path)
