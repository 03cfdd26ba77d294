"""Which processor stalls least: `python -m benchmarks.loops.stalls` shows them all.

A virtual machine, an interrupt or the kernel's own work takes a processor away from every thread,
one with a real-time priority too. A loop at 1 kHz loses periods there whatever it does.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time

PRIORITY = 80  # under SCHED_FIFO
SECONDS = 5.0  # [s] on each processor: stalls of once a second are seen several times
_NAP, _LATE = 0.5e-3, 0.5e-3  # [s] of sleep, and how late its end is a stall


def permitted_priority() -> int:
    """PRIORITY where this process may ask for it, else 0, the normal one."""
    try:
        now = os.sched_getscheduler(0), os.sched_getparam(0)
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
        os.sched_setscheduler(0, *now)
    except OSError:
        return 0
    return PRIORITY


def calmest_processor(priority: int) -> int:
    """The one with the fewest stalls among those of this process; of several the last one."""
    found = stalls(priority)
    return min(reversed(found), key=lambda cpu: found[cpu])


def stalls(priority: int, seconds: float = SECONDS) -> dict[int, int]:
    """Stalls within `seconds` [s] at a priority, by processor, all at the same time.

    Raises:
        subprocess.CalledProcessError: the priority is refused.
    """
    cpus = sorted(os.sched_getaffinity(0))
    command = [sys.executable, "-m", "benchmarks.loops.stalls"]
    running = {
        cpu: subprocess.Popen(
            [*command, str(cpu), str(priority), str(seconds)], stdout=subprocess.PIPE, text=True
        )
        for cpu in cpus
    }
    found = {}
    for cpu, process in running.items():
        answer, _ = process.communicate()
        if process.returncode != 0:
            raise subprocess.CalledProcessError(process.returncode, process.args)
        found[cpu] = int(answer)
    return found


def _count(cpu: int, priority: int, seconds: float) -> int:
    """Naps on a processor whose end was late."""
    os.sched_setaffinity(0, {cpu})
    if priority:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    late, end = 0, time.monotonic() + seconds
    before = time.monotonic()
    while before < end:
        time.sleep(_NAP)
        now = time.monotonic()
        late += now - before > _NAP + _LATE
        before = now
    return late


def main() -> None:
    """One processor as it is asked for, or a line for each."""
    if len(sys.argv) > 1:
        number, priority, seconds = sys.argv[1:]
        print(_count(int(number), int(priority), float(seconds)))
        return
    priority = permitted_priority()
    for cpu, late in stalls(priority).items():
        print(
            f"cpu {cpu}: {late} stalls of {_LATE * 1e3:g} ms or more in {SECONDS:g} s at "
            + (
                f"priority {priority}"
                if priority
                else "normal priority (`ulimit -r` allows no other)"
            )
        )


if __name__ == "__main__":
    main()
