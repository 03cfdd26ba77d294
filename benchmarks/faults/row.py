"""A row of the matrix: a fault, how it is injected, and what has to hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from benchmarks.faults.session import Session

Inject = Callable[[Session, np.random.Generator], None]


class Bench(Enum):
    """Which nodes run, and how."""

    ARM = "arm"  # bridge and controller, 5 ms
    FAST = "fast"  # the same at 1 kHz
    CONTACT = "generators"  # before an obstacle, with both generators, 5 ms


@dataclass(frozen=True, slots=True)
class Limits:
    """What a run has to keep, beside no dead node and no number that is not finite."""

    torque: float = 1.0  # [-] applied, of the torque limit
    rate: float = 1000.0  # [Nm/s] applied, over any edge
    speed: float = 2.0  # [-] of the velocity limit
    recovery: float = 2.0  # [s] wall, until a request is served again
    hold: float | None = None  # [s] of the bridge's clock, from the last command to a hold


@dataclass(frozen=True, slots=True)
class Row:
    """One fault."""

    name: str
    inject: Inject
    group: str
    moving: bool = True  # injected in fast motion
    bench: Bench = Bench.ARM
    after: float = 1.0  # [s] wall watched after the injection
    latches: bool = False  # a latched fault is a stated outcome; it is then reset
    limits: Limits = field(default_factory=Limits)
    quick: bool = False  # part of the short campaign


def nothing(_: Session, __: np.random.Generator) -> None:
    """No fault: the baseline."""
