"""Reserves a ROS domain id that no other run on this machine uses."""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
from pathlib import Path
from typing import IO

from ghc_controller.errors import GhcError

# Ids above 101 lead to ports in Linux' ephemeral range.
_DOMAINS = range(1, 102)


class DomainLock:
    """Holds a domain id by a lock file until `release`; the lock ends with the process."""

    def __init__(self) -> None:
        self._file: IO[str] | None = None
        given = os.environ.get("ROS_DOMAIN_ID", "")
        self.id = int(given) if given.isdigit() else self._take()

    def release(self) -> None:
        """Give the id back."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def _take(self) -> int:
        folder = Path(tempfile.gettempdir()) / "ghc_ros_domains"
        with contextlib.suppress(FileExistsError):
            folder.mkdir()
            folder.chmod(0o1777)  # whatever the umask: other users of this host lock here too
        for domain in _DOMAINS:
            with contextlib.ExitStack() as held, contextlib.suppress(OSError):
                file = held.enter_context(_open_lock(folder / f"{domain}.lock"))
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                held.pop_all()
                self._file = file
                return domain
        raise GhcError(
            f"no free ROS domain among {_DOMAINS[0]} to {_DOMAINS[-1]} (locks in {folder}); set "
            "ROS_DOMAIN_ID"
        )


def _open_lock(path: Path) -> IO[str]:
    """The file to lock, which may belong to another user; OSError where it cannot be opened."""
    try:
        return path.open(encoding="utf-8")  # a lock needs no right to write
    except FileNotFoundError:
        with path.open("x", encoding="utf-8"):
            path.chmod(0o666)
        return path.open(encoding="utf-8")
