"""The page of a run that has ended stays while a browser looks at it."""

from __future__ import annotations

import socket
import time
from pathlib import Path

import pytest

from ghc_sim_bridge.viewer.page_keeper import browsers, keep


def test_it_is_kept_while_it_is_seen() -> None:
    """Seen ten times, 10 ms apart; with a patience of 50 ms it ends after the last one."""
    looks = iter([True] * 10 + [False] * 1000)
    begin = time.monotonic()
    keep(lambda: True, lambda: next(looks), 0.05, 0.01)
    assert time.monotonic() - begin >= 0.14
    assert next(looks) is False


def test_a_viewer_that_was_closed_is_not_waited_for() -> None:
    begin = time.monotonic()
    keep(lambda: False, lambda: True, 60.0)
    assert time.monotonic() - begin < 30.0


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="reads Linux' table of sockets")
def test_connections_are_counted_at_the_server() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        assert browsers(port) == 0
        with socket.create_connection(("127.0.0.1", port)):
            assert browsers(port) == 1
