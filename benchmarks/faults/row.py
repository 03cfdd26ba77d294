"""A row of the matrix: a fault, its injection, and the required properties."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from benchmarks.faults.session import Session
from benchmarks.faults.subject import ARM, HUMANOID, Subject

Inject = Callable[[Session, np.random.Generator], None]


class Bench(Enum):
    """Which nodes run, and how."""

    ARM = "arm"  # bridge and controller, 5 ms
    FAST = "fast"  # the same at 1 kHz
    CONTACT = "generators"  # before an obstacle, with both generators, 5 ms
    TOUCH = "wrenches"  # above a table, states wait for the wrench at the tool, 5 ms
    BASE = "odometry"  # a humanoid that stands, 5 ms

    @property
    def subject(self) -> Subject:
        """Its robot."""
        return HUMANOID if self is Bench.BASE else ARM


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a run, in addition to: no dead node, all numbers finite."""

    torque: float = 1.0  # [-] applied, of the torque limit
    rate: float = 1000.0  # [Nm/s] applied, over any edge
    speed: float = 2.0  # [-] of the velocity limit
    recovery: float = 2.0  # [s] wall, until a request is served again
    hold: float | None = None  # [s] of the bridge's clock, from the last command to a hold
    works_on: float = 0.1  # [s] wall after a single message, until a request is served


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

    @property
    def slug(self) -> str:
        """Its name as part of the name of a folder."""
        return "".join(c if c.isalnum() else "_" for c in self.name)[:40]

    @property
    def single(self) -> bool:
        """Whether it is a single message, after which operation must continue at once."""
        return self.name.startswith("ONE ")


def nothing(_: Session, __: np.random.Generator) -> None:
    """No fault: the baseline."""
