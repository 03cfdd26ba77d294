"""CPU affinity of the nodes of a run."""

from __future__ import annotations

import os
from collections.abc import Iterable

TAKING_TURNS = ("sim_bridge", "controller")  # in lockstep only one of them is busy

Cpus = frozenset[int]


def lockstep_placement(
    nodes: Iterable[str], number: int, available: Iterable[int] | None = None
) -> dict[str, Cpus]:
    """Node -> CPUs of a run in lockstep; empty where there is only one CPU.

    The nodes that take turns share one CPU: it does not idle between a state and its command,
    and its caches stay valid. All other nodes share the rest. Runs with consecutive numbers use
    different CPUs.

    Args:
        available: usable CPUs; default: those of this process.
    """
    cpus = sorted(os.sched_getaffinity(0) if available is None else available)
    if len(cpus) < 2:
        return {}
    shared = frozenset({cpus[number % len(cpus)]})
    rest = frozenset(cpus) - shared
    return {name: shared if name in TAKING_TURNS else rest for name in nodes}
