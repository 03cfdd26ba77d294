"""Lock files shared by all users of this host."""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
from pathlib import Path


def shared_folder(name: str) -> Path:
    """The folder of that name in the temporary directory, created if needed.

    Raises:
        OSError: it cannot be created.
    """
    folder = Path(tempfile.gettempdir()) / name
    with contextlib.suppress(FileExistsError):
        folder.mkdir()
        folder.chmod(0o1777)  # regardless of the umask
    return folder


def open_shared(path: Path, flags: int = os.O_RDONLY) -> int:
    """Descriptor of the file at `path`, possibly owned by another user; created if needed.

    Raises:
        OSError: it cannot be opened.
    """
    with contextlib.suppress(FileNotFoundError):
        return os.open(path, flags | os.O_NOFOLLOW)
    with contextlib.suppress(FileExistsError):
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
        path.chmod(0o666)
    return os.open(path, flags | os.O_NOFOLLOW)


def try_lock(file: int, kind: int) -> bool:
    """Lock an open file without waiting; `kind` is fcntl.LOCK_EX or fcntl.LOCK_SH."""
    try:
        fcntl.flock(file, kind | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
