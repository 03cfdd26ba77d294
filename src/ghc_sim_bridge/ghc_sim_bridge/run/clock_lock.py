"""Lock for the bridge of this host that publishes a clock, since discovery is too slow."""

from __future__ import annotations

import fcntl
import os
import struct
from pathlib import Path

from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.run.shared_folder import open_shared, shared_folder, try_lock

AHEAD_NS = NANOSECONDS  # [ns] increment of the floor, so that it is written once per second
_FLOOR = struct.Struct("<q")


class ClockLock:
    """Exclusive right to publish one clock, and the time from which a successor continues.

    There are two lock files per clock. `members` is a shared lock held by every running bridge: a
    bridge that finds no other holder starts a new clock. `owner` is held by the publisher; its
    content is a floor [ns] that exceeds all published times, and so is valid even after a crash.
    Locks end with their process.
    """

    def __init__(self, domain: int, topic: str) -> None:
        """Join the bridges that share `topic` in a ROS `domain` and network namespace.

        Raises:
            OSError: the temporary directory cannot be used.
        """
        network = Path("/proc/self/ns/net").stat().st_ino
        stem = f"{network}_{domain}_{topic.strip('/').replace('/', '.')}"
        folder = shared_folder("ghc_clocks")
        self.held = False
        self._members = open_shared(folder / f"{stem}.members")
        self._owner = open_shared(folder / f"{stem}.owner", os.O_RDWR)
        self._floor_ns = -1  # [ns] while held: content of the file
        self.alone = try_lock(self._members, fcntl.LOCK_EX)
        if self.alone:
            os.pwrite(self._owner, _FLOOR.pack(-1), 0)
        fcntl.flock(self._members, fcntl.LOCK_SH)

    def take(self, now_ns: int) -> bool:
        """Acquire the clock for a bridge at time `now_ns`; False if it is not available (yet)."""
        if self.held:
            return True
        if now_ns < self._read_floor() or not try_lock(self._owner, fcntl.LOCK_EX):
            return False
        self.held = now_ns >= self._read_floor()  # may have been raised by a previous owner
        if not self.held:
            fcntl.flock(self._owner, fcntl.LOCK_UN)
        return self.held

    def promise(self, now_ns: int) -> None:
        """Call before publishing each time: a successor starts later."""
        if now_ns > self._floor_ns:
            self._floor_ns = now_ns + AHEAD_NS
            os.pwrite(self._owner, _FLOOR.pack(self._floor_ns), 0)

    def close(self) -> None:
        """Release the clock; others continue from the floor."""
        for file in (self._owner, self._members):
            os.close(file)
        self.held = False

    def _read_floor(self) -> int:
        data = os.pread(self._owner, _FLOOR.size, 0)
        return int(_FLOOR.unpack(data)[0]) if len(data) == _FLOOR.size else -1
