"""Lock of a results folder, so that only one experiment at a time writes to it."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ghc_controller.errors import GhcError

_held: set[Path] = set()  # by this process


@contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Lock `folder`, which need not exist, until the context or the process ends.

    The lock is reentrant: an experiment holds it, and so does each of its runs.

    Raises:
        GhcError: another process holds the lock.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    path = folder.parent.resolve() / f".{folder.name}.lock"
    if path in _held:
        yield
        return
    with path.open("a", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise GhcError(
                f"{folder} is being written by another experiment: wait for its end, or give "
                "another folder with --output"
            ) from error
        _held.add(path)
        try:
            yield
        finally:
            _held.remove(path)
