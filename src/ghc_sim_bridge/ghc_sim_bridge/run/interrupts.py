"""Ctrl-C and SIGTERM for commands with child processes: ends them, exit code 130."""

from __future__ import annotations

import sys
from collections.abc import Callable

from ghc_controller.ros.stop_signals import interrupt_on_stop_signals, stop_was_asked

INTERRUPTED = 130


def interruptible(name: str, command: Callable[[], int]) -> int:
    """Run a command and return its exit code; both signals unwind it and end its processes."""
    interrupt_on_stop_signals()
    try:
        code = command()
    except KeyboardInterrupt:
        code = INTERRUPTED
    except Exception:
        # pybind11 turns an interrupt inside the conversion of a message into a RuntimeError.
        if not stop_was_asked():
            raise
        code = INTERRUPTED
    if code and stop_was_asked():
        print(f"{name}: interrupted; all nodes were ended", file=sys.stderr)
        return INTERRUPTED
    return code
