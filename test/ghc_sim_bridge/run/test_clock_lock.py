"""Of bridges that share a clock one has it, and the next one never goes back behind it."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import pytest

from ghc_sim_bridge.run.clock_lock import AHEAD_NS, ClockLock

SECOND = 1_000_000_000  # [ns]
PUBLISH = """
import sys, tempfile, time
tempfile.tempdir = sys.argv[1]
from ghc_sim_bridge.run.clock_lock import ClockLock
lock = ClockLock(7, "/clock")
assert lock.alone and lock.take(0)
for now_ns in range(0, 3_000_000_001, 1_000_000):
    lock.promise(now_ns)
print("held", flush=True)
time.sleep(60)
"""


@pytest.fixture(autouse=True)
def own_tmp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A temporary folder in which no lock was ever taken."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))


def test_a_clock_goes_on_from_where_a_killed_owner_left_it(tmp_path: Path) -> None:
    """Not earlier, not for one that starts anew meanwhile; anew only when all have ended."""
    owner = subprocess.Popen([sys.executable, "-c", PUBLISH, tmp_path], stdout=subprocess.PIPE)
    assert owner.stdout is not None
    assert owner.stdout.readline() == b"held\n"
    second = ClockLock(7, "/clock")
    assert not second.alone
    assert not second.take(100 * SECOND)
    owner.kill()
    owner.wait()
    third = ClockLock(7, "/clock")  # the same robot, started again: its time is 0
    assert not third.take(0)
    assert not second.take(3 * SECOND - 1)  # published by the first one
    assert second.take(3 * SECOND + AHEAD_NS + 1)
    assert not third.take(100 * SECOND)
    second.close()
    third.close()
    anew = ClockLock(7, "/clock")
    assert anew.alone
    assert anew.take(0)
    anew.close()


def test_clocks_of_other_domains_and_topics_are_others() -> None:
    locks = [ClockLock(7, "/clock"), ClockLock(8, "/clock"), ClockLock(7, "/left/clock")]
    assert all(lock.take(0) for lock in locks)
    for lock in locks:
        lock.close()


def test_of_bridges_that_start_at_once_one_has_the_clock() -> None:
    """40 times eight of them, released together."""
    for domain in range(40):
        barrier = threading.Barrier(8)
        locks: list[ClockLock] = []

        def start(domain: int = domain, barrier: threading.Barrier = barrier) -> None:
            barrier.wait()
            lock = ClockLock(domain, "/clock")
            if lock.take(0):
                lock.promise(0)
            locks.append(lock)  # noqa: B023

        threads = [threading.Thread(target=start) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert sum(lock.held for lock in locks) == 1
        for lock in locks:
            lock.close()
