"""Ctrl-C and SIGTERM, also where a parent ignores them: nohup, cron, a job in the background.

A program that is started while SIGINT is ignored inherits that, Python then raises no
KeyboardInterrupt, and all that it starts inherits it in turn.
"""

from __future__ import annotations

import signal

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def interrupt_on_stop_signals() -> None:
    """Both signals raise KeyboardInterrupt from now on, whatever was inherited."""
    for number in STOP_SIGNALS:
        signal.signal(number, _interrupt)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)


def restore_stop_signals() -> None:
    """Let both signals end this process; to be called in a child between fork and exec."""
    for number in STOP_SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)


def _interrupt(_number: int, _frame: object) -> None:
    raise KeyboardInterrupt
