"""An output stream written to the disk in commits, each of which leaves a complete file."""

from __future__ import annotations

import os
from pathlib import Path


class CutSafeFile:
    """Bytes are buffered until `commit` writes them together with an end for the file. The next
    commit overwrites that end. After a kill, or on a full disk, the file is therefore that of the
    last commit.
    """

    def __init__(self, path: Path) -> None:
        """Create the file, or empty it.

        Raises:
            OSError: it cannot be written there.
        """
        self._file = path.open("wb", buffering=0)
        self._pending = bytearray()
        self._end = 0  # [bytes] written by commits, without the end of the file
        self._tail = b""  # that end, as the last commit wrote it

    def write(self, data: bytes) -> int:
        """Buffer `data` until the next commit; returns its size [bytes]."""
        self._pending += data
        return len(data)

    def tell(self) -> int:
        """Position [bytes] of the next byte."""
        return self._end + len(self._pending)

    @property
    def pending(self) -> int:
        """Bytes that wait for a commit."""
        return len(self._pending)

    def flush(self) -> None:
        """Called by the writer of the format; bytes go to the disk in `commit` only."""

    def commit(self, tail: bytes) -> None:
        """Write the buffered bytes, followed by `tail`.

        Raises:
            OSError: no space is left, for example; the file is the one of the last commit.
        """
        fd = self._file.fileno()
        try:
            # One call: a kill during it leaves a truncated file at worst.
            _write_all(fd, bytes(self._pending) + tail, self._end)
        except OSError:
            _write_all(fd, self._tail, self._end)  # over bytes that the file already had
            os.ftruncate(fd, self._end + len(self._tail))
            raise
        self._end += len(self._pending)
        self._tail = tail
        self._pending.clear()
        os.ftruncate(fd, self._end + len(tail))

    def close(self) -> None:
        """Close the file as the last commit left it."""
        self._file.close()


def _write_all(fd: int, data: bytes, offset: int) -> None:
    """Write all of `data` at `offset` [bytes]; a disk that fills up takes a part of it first."""
    view = memoryview(data)
    while view:
        count = os.pwrite(fd, view, offset)
        view, offset = view[count:], offset + count
