"""One experiment at a time writes a folder of results."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ghc_controller.errors import GhcError


@contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Hold `folder`, which need not exist, until the context is left or the process ends.

    Raises:
        GhcError: another process holds it.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    path = folder.parent / f".{folder.name}.lock"
    with path.open("a", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise GhcError(
                f"{folder} is being written by another experiment: wait for its end, or give "
                "another folder with --output"
            ) from error
        yield
