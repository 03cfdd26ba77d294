"""Network conditions and required properties of each row."""

from __future__ import annotations

from dataclasses import dataclass, field

from benchmarks.faults.row import Limits
from benchmarks.hosts.conditions import Conditions

MS = 1e-3  # [s]
CUT = Conditions(cut=True)
HELD = Limits(hold=0.020, recovery=2.0)
# Fast DDS forgets a host that was silent for 20 s, and calls every 3 s.
FORGOTTEN = Limits(hold=0.020, recovery=10.0)


@dataclass(frozen=True, slots=True)
class HostRow:
    """One condition."""

    name: str
    conditions: Conditions
    lasts: float = 6.0  # [s] wall
    limits: Limits = field(default_factory=Limits)
    quick: bool = False  # part of the short campaign


ROWS = (
    HostRow("no delay", Conditions(), quick=True),
    HostRow("delay 1 ms", Conditions(1 * MS)),
    HostRow("delay 5 ms", Conditions(5 * MS)),
    HostRow("delay 5 +- 4 ms", Conditions(5 * MS, 4 * MS)),
    HostRow("delay 12 ms", Conditions(12 * MS)),
    HostRow("1 % lost", Conditions(loss=0.01)),
    HostRow("10 % lost", Conditions(loss=0.1)),
    HostRow("delay 5 +- 4 ms, 10 % lost", Conditions(5 * MS, 4 * MS, 0.1)),
    HostRow("cut for 0.2 s", CUT, 0.2, HELD, quick=True),
    HostRow("cut for 5 s", CUT, 5.0, HELD),
    HostRow("cut for 30 s", CUT, 30.0, FORGOTTEN),
)
