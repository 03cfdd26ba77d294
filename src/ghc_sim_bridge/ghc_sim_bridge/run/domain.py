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
        folder.mkdir(mode=0o777, exist_ok=True)
        for domain in _DOMAINS:
            with contextlib.ExitStack() as held, contextlib.suppress(OSError):
                file = held.enter_context((folder / f"{domain}.lock").open("a"))
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                held.pop_all()
                self._file = file
                return domain
        raise GhcError(
            f"no free ROS domain among {_DOMAINS[0]} to {_DOMAINS[-1]}; set ROS_DOMAIN_ID"
        )
