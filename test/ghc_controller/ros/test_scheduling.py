"""Parameters of a node that the system carries out, in a process of their own."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

_PROGRAM = """
import os, threading
from ghc_controller.ros.process.scheduling import Scheduling

stop = threading.Event()
thread = threading.Thread(target=stop.wait)
thread.start()
try:
    Scheduling({arguments}).apply()
    for task in map(int, os.listdir("/proc/self/task")):
        print(os.sched_getscheduler(task), os.sched_getparam(task).sched_priority,
              *sorted(os.sched_getaffinity(task)))
    print([line.split()[1] for line in open("/proc/self/status") if line.startswith("VmLck")][0])
except Exception as error:
    print(type(error).__name__, error)
finally:
    stop.set()
"""


def _run(arguments: str) -> list[str]:
    """What each thread has, then the locked memory [kB]; or the error."""
    code = _PROGRAM.format(arguments=arguments)
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    return run.stdout.splitlines()


def _may_be_realtime() -> bool:
    try:
        now = os.sched_getscheduler(0), os.sched_getparam(0)
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        os.sched_setscheduler(0, *now)
    except OSError:
        return False
    return True


def test_nothing_is_asked_for_by_default() -> None:
    *threads, locked = _run("")
    everything = " ".join(map(str, sorted(os.sched_getaffinity(0))))
    assert threads == [f"{os.SCHED_OTHER} 0 {everything}"] * len(threads)
    assert len(threads) >= 2
    assert locked == "0"


def test_all_threads_run_on_the_processor_asked_for() -> None:
    one = min(os.sched_getaffinity(0))
    *threads, _ = _run(f"cpu={one}")
    assert threads == [f"{os.SCHED_OTHER} 0 {one}"] * len(threads)


@pytest.mark.skipif(not _may_be_realtime(), reason="needs the permission of a real-time priority")
def test_all_threads_have_the_priority() -> None:
    *threads, _ = _run("realtime_priority=7")
    assert [thread.split()[:2] for thread in threads] == [[str(os.SCHED_FIFO), "7"]] * len(threads)


def test_memory_is_locked() -> None:
    *_, locked = _run("lock_memory=True")
    if locked.startswith("ConfigurationError parameter 'lock_memory'"):
        pytest.skip("needs the permission to lock memory")
    assert int(locked) > 1000


def test_what_the_system_refuses_is_said() -> None:
    (said,) = _run("cpu=100000")
    assert said.startswith("ConfigurationError parameter 'cpu': ")
