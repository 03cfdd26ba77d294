"""The epoch of a message, a count of resets that travels in `frame_id`."""

from __future__ import annotations

_DIGITS = 18  # more are no count, and thousands of them no number for Python either


def epoch_number(frame_id: str) -> int | None:
    """Epoch written in a `frame_id`, "" being epoch 0; None where it is none."""
    if not frame_id:
        return 0
    return int(frame_id) if frame_id.isdecimal() and len(frame_id) <= _DIGITS else None
