"""How the system schedules a node: real-time priority, locked memory, processor."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ghc_controller.errors import ConfigurationError
from ghc_controller.schema.domains import Range
from ghc_controller.schema.parameters import parameter

_CURRENT_AND_FUTURE = 1 | 2  # MCL_CURRENT | MCL_FUTURE of mlockall, from sys/mman.h
_LIBRARY = ctypes.CDLL(None, use_errno=True)


@dataclass(frozen=True, slots=True)
class Scheduling:
    """Parameters that take effect for all threads of the process, those of the middleware too."""

    realtime_priority: int = parameter(
        0,
        "[-] priority under SCHED_FIFO, needs the permission (`ulimit -r`); 0 = normal",
        Range(minimum=0.0, maximum=99.0),
    )
    lock_memory: bool = parameter(
        False, "keep all memory of the process in RAM, needs the permission (`ulimit -l`)"
    )
    cpu: int = parameter(
        -1,
        "[-] number of the processor to run on; -1 = those it was started on",
        Range(minimum=-1.0),
    )

    def apply(self) -> None:
        """Make the system do so; threads that are started later do as the one that starts them.

        Raises:
            ConfigurationError: the system refuses it.
        """
        if self.cpu >= 0:
            _of_threads("cpu", "`nproc --all` gives how many there are", self._bind)
        if self.lock_memory:
            _lock_memory()
        if self.realtime_priority:  # last: from now on nothing else of the node comes before it
            _of_threads("realtime_priority", "`ulimit -r` gives the largest", self._prioritize)

    def _bind(self, thread: int) -> None:
        os.sched_setaffinity(thread, {self.cpu})

    def _prioritize(self, thread: int) -> None:
        os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(self.realtime_priority))


def _of_threads(name: str, advice: str, act: Callable[[int], None]) -> None:
    for thread in [int(entry.name) for entry in Path("/proc/self/task").iterdir()]:
        try:
            act(thread)
        except ProcessLookupError:
            continue  # ended since it was listed
        except (OSError, ValueError, OverflowError) as error:
            raise ConfigurationError(f"parameter '{name}': {error} ({advice})") from None


def _lock_memory() -> None:
    if _LIBRARY.mlockall(_CURRENT_AND_FUTURE) != 0:
        reason = os.strerror(ctypes.get_errno())
        raise ConfigurationError(f"parameter 'lock_memory': {reason} (`ulimit -l` gives the most)")
