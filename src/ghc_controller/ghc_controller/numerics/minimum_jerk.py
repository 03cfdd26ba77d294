"""The polynomial of least jerk between two states of rest."""

from __future__ import annotations


def minimum_jerk(s: float) -> tuple[float, float, float]:
    """Share of the way at a share s of the time, and its first two derivatives by s.

    s is clipped to [0, 1]; both derivatives are 0 at both ends.
    """
    s = min(max(s, 0.0), 1.0)
    return (
        minimum_jerk_share(s),
        30.0 * s**2 * (1.0 - s) ** 2,
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    )


def minimum_jerk_share(s: float) -> float:
    """The share of the way alone, at s in [0, 1]."""
    return min(s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 1.0)
