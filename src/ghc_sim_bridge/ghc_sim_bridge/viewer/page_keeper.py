"""Keeps the page of a finished run available until no browser is connected.

    python -m ghc_sim_bridge.viewer.page_keeper PROCESS PORT SECONDS

It is a separate process, since the node that started the viewer has ended by then.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

_TABLES = (Path("/proc/net/tcp"), Path("/proc/net/tcp6"))
_ESTABLISHED = "01"
_PERIOD = 1.0  # [s]


def browsers(port: int) -> int:
    """Connections to a port of this machine, as listed by Linux; 1 if there are no lists."""
    found, readable = 0, False
    for table in _TABLES:
        if not table.exists():
            continue
        readable = True
        for line in table.read_text(encoding="utf-8").splitlines()[1:]:
            _, local, _, state = line.split()[:4]
            if state == _ESTABLISHED and int(local.rpartition(":")[2], 16) == port:
                found += 1
    return found if readable else 1


def keep(
    is_there: Callable[[], bool],
    is_seen: Callable[[], bool],
    patience: float,
    period: float = _PERIOD,
) -> None:
    """Return after `patience` [s] without a connection, or once the viewer has ended."""
    seen_at = time.monotonic()
    while is_there() and time.monotonic() - seen_at < patience:
        if is_seen():
            seen_at = time.monotonic()
        time.sleep(period)


def main(process: int, port: int, patience: float) -> None:
    """Keep the viewer `process`, then end it."""
    keep(lambda: _runs(process), lambda: browsers(port) > 0, patience)
    if _runs(process):
        os.killpg(process, signal.SIGTERM)


def _runs(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2]
    except OSError:
        return False
    return state.split()[0] != "Z"


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]))
