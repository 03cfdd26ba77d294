"""Validation messages for configuration values; empty if the value is valid."""

from __future__ import annotations

import math


def is_number(value: object) -> bool:
    """Whether it is a finite number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def vector_problem(value: object, size: int | None) -> str:
    """Of a list of `size` entries, any number of them for None; the entries are not looked at."""
    if not isinstance(value, (list, tuple)):
        wanted = "a list of numbers" if size is None else f"{size} numbers"
        return f"{wanted} expected, {shown(value)} given"
    if size is not None and len(value) != size:
        return f"{size} numbers expected, {len(value)} given: {shown(value)}"
    return ""


def shown(value: object) -> str:
    """A value in a message, cut to one short piece."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
