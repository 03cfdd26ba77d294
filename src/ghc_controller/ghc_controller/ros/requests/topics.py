"""Topics of requests: their message types and the largest size accepted."""

from __future__ import annotations

from collections.abc import Mapping

from ghc_msgs.msg import PriorityTransition, TaskReference

TRANSITION, REFERENCE = "ghc/priority_transition", "ghc/task_reference"
KINDS: Mapping[str, type] = {TRANSITION: PriorityTransition, REFERENCE: TaskReference}

# [bytes] of a serialized request: a reference of over a thousand points, a hierarchy of any robot.
_MOST_BYTES = {TRANSITION: 1 << 16, REFERENCE: 1 << 18}
_MOST_BYTES_LOCKSTEP = 1 << 26  # [bytes] simulated time stops meanwhile


def most_bytes(topic: str, lockstep: bool) -> int:
    """Largest serialized request [bytes] that is accepted on a topic."""
    return _MOST_BYTES_LOCKSTEP if lockstep else _MOST_BYTES[topic]
