"""Counts of rejected or corrected inputs by field; how often and for how long they are told."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Mapping

WARNING_PERIOD = 1.0  # [s] at most one warning per field and period
WARNED_FOR = 10.0  # [s] wall, for which a count that rose is a warning in /diagnostics
# End of a warning: what the node does now. Looked up by the beginning of the field.
CONTROLLER: Mapping[str, str] = {
    "joint_states": "this state is not answered, others are",
    "odom": "the state of its stamp is not answered unless another one comes",
    "contacts/": "the state of its stamp is not answered unless another one comes",
    "sim_bridge/epoch": "the current run goes on",
    "constraints/preview": "the previous plan stays active",
    "ghc/priority_transition": "the priorities stay as they are",
    "ghc/task_reference": "the previous reference stays active",
    "requests": "those that wait are served",
}
GENERATOR: Mapping[str, str] = {
    "ghc/tick": "nothing is planned for it",
    "ghc/controller_state": "the plan begins without what is active",
    "sim_bridge/epoch": "the current run goes on",
    "constraints/": "what was known stays active",
}
BRIDGE: Mapping[str, str] = {
    "torque_": "what the limits allow is applied",
    "": "the previous command stays active, and the robot is held if no other one comes",
}


class Rejections:
    """Counts events per field; warns of each field at most once per period."""

    def __init__(self) -> None:
        """Begin with no events."""
        self.counts: Counter[str] = Counter()
        self._warned_at: dict[str, float] = {}

    def count(self, field: str, now: float) -> bool:
        """Note an event of `field` at `now` [s]; True when it is time to warn."""
        self.counts[field] += 1
        if now - self._warned_at.get(field, -WARNING_PERIOD) < WARNING_PERIOD:
            return False
        self._warned_at[field] = now
        return True


class Recent:
    """Tells whether a count has risen within the last WARNED_FOR seconds; the count stays."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """`clock` gives wall time [s]."""
        self._clock = clock
        self._count, self._rose_at = 0, float("-inf")

    def rose(self, count: int) -> bool:
        """Whether the count, now `count`, has risen lately; one that fell began anew."""
        now = self._clock()
        if count > self._count:
            self._rose_at = now
        self._count = count
        return now - self._rose_at <= WARNED_FOR

    def told(self, count: int, summary: str, fine: str = "ok") -> tuple[bool, str]:
        """Whether it is a warning, and the line for it: `summary` alone only while it is one."""
        recent = self.rose(count)
        if not count:
            return False, fine
        return recent, summary if recent else f"{fine}; before: {summary}"


def warning(field: str, reason: str, consequences: Mapping[str, str]) -> str:
    """One line: the field, what was given and expected, and what the node does.

    Args:
        reason: may begin with the field or a part of it, which is then not repeated.
        consequences: by the beginning of the field; the first one that fits counts.
    """
    text = reason if reason.startswith(field.removesuffix(".jump")) else f"{field}: {reason}"
    if field.endswith((".left_out", ".jump")):  # not rejected: the rest of the message is used
        return text
    then = next((then for start, then in consequences.items() if field.startswith(start)), "")
    return f"{text}; {then}" if then else text
