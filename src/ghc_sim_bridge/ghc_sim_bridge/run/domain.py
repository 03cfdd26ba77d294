"""Reserves a ROS domain id that no other run on this machine uses."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

from ghc_controller.errors import GhcError
from ghc_sim_bridge.run.shared_folder import open_shared, shared_folder, try_lock

# Ids above 101 use ports in the ephemeral range of Linux.
_DOMAINS = range(1, 102)
_FOLDER = "ghc_ros_domains"  # of lock files


class DomainLock:
    """Holds a domain id by a lock file until `release`; the lock ends with the process."""

    def __init__(self, alone: bool = False) -> None:
        """Reserve a free id, or the one of ROS_DOMAIN_ID.

        Args:
            alone: do not share a given id with another user that is `alone`.

        Raises:
            GhcError: no id is free, or the given one is taken.
        """
        self._file: int | None = None
        given = os.environ.get("ROS_DOMAIN_ID", "")
        self.id = int(given) if given.isdigit() else self._take()
        if self._file is None and alone:
            self._file = _locked(shared_folder(_FOLDER) / f"{self.id}.experiment.lock")
            if self._file is None:
                raise GhcError(
                    f"another experiment runs in the domain of ROS_DOMAIN_ID={self.id}: wait for "
                    "its end, or unset it, and each takes a domain of its own"
                )

    def release(self) -> None:
        """Release the id."""
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def _take(self) -> int:
        folder = shared_folder(_FOLDER)
        for domain in _DOMAINS:
            self._file = _locked(folder / f"{domain}.lock")
            if self._file is not None:
                return domain
        raise GhcError(
            f"no free ROS domain among {_DOMAINS[0]} to {_DOMAINS[-1]} (locks in {folder}); set "
            "ROS_DOMAIN_ID"
        )


def _locked(path: Path) -> int | None:
    """Descriptor of a locked file; None if another process has it, or it cannot be opened."""
    try:
        file = open_shared(path)
    except OSError:
        return None
    if try_lock(file, fcntl.LOCK_EX):
        return file
    os.close(file)
    return None
