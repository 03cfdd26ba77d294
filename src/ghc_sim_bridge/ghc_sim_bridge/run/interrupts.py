"""Ctrl-C and SIGTERM for commands that start processes: all is ended, one line, exit code 130."""

from __future__ import annotations

import sys
from collections.abc import Callable

from ghc_controller.ros.stop_signals import interrupt_on_stop_signals, stop_was_asked

INTERRUPTED = 130


def interruptible(name: str, command: Callable[[], int]) -> int:
    """Exit code of a command; both signals unwind it, so that its processes are ended."""
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
