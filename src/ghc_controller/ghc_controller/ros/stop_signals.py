"""Ctrl-C and SIGTERM, even if the parent process ignores them: nohup, cron, background jobs.

A process started while SIGINT is ignored inherits this, and so do its children; Python then raises
no KeyboardInterrupt. A signal that arrives while compiled code calls Python may surface as another
exception or not at all; `stop_was_asked` reports it.
"""

from __future__ import annotations

import signal
import threading

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_ASKED = threading.Event()


def interrupt_on_stop_signals() -> None:
    """Make both signals raise KeyboardInterrupt, regardless of inherited handlers."""
    _ASKED.clear()
    for number in STOP_SIGNALS:
        signal.signal(number, _interrupt)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)


def stop_was_asked() -> bool:
    """Whether either signal was received since `interrupt_on_stop_signals`."""
    return _ASKED.is_set()


def raise_if_stopped() -> None:
    """Raise a KeyboardInterrupt that compiled code may have swallowed; for waiting loops."""
    if stop_was_asked():
        raise KeyboardInterrupt


def restore_stop_signals() -> None:
    """Restore the default action of both signals; called in a child between fork and exec."""
    for number in STOP_SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)


def _interrupt(_number: int, _frame: object) -> None:
    _ASKED.set()
    raise KeyboardInterrupt
