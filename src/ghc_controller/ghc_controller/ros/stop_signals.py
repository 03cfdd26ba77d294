"""Ctrl-C and SIGTERM, also where a parent ignores them: nohup, cron, a job in the background.

A program that is started while SIGINT is ignored inherits that, Python then raises no
KeyboardInterrupt, and all that it starts inherits it in turn. A signal that arrives while compiled
code calls Python may surface as another exception, or as none: `stop_was_asked` tells.
"""

from __future__ import annotations

import signal
import threading

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_ASKED = threading.Event()


def interrupt_on_stop_signals() -> None:
    """Both signals raise KeyboardInterrupt from now on, whatever was inherited."""
    _ASKED.clear()
    for number in STOP_SIGNALS:
        signal.signal(number, _interrupt)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)


def stop_was_asked() -> bool:
    """Whether one of both signals came since `interrupt_on_stop_signals`."""
    return _ASKED.is_set()


def raise_if_stopped() -> None:
    """Raise the KeyboardInterrupt that compiled code may have swallowed; for loops that wait."""
    if stop_was_asked():
        raise KeyboardInterrupt


def restore_stop_signals() -> None:
    """Let both signals end this process; to be called in a child between fork and exec."""
    for number in STOP_SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)


def _interrupt(_number: int, _frame: object) -> None:
    _ASKED.set()
    raise KeyboardInterrupt
