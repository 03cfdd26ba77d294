"""Status of a row of a preview."""

from __future__ import annotations

from enum import Enum


class PreviewStatus(Enum):
    """Status of a row of a preview; the value is used in messages."""

    SMOOTHED = 0  # the optimum of the preview
    RAW = 1  # as given: smoothing off, or an obstacle outside its safe distance
    HELD = 2  # no solution: the previous preview, as far as it reaches, inside the raw bounds
    TIGHTENED = 3  # no solution and no preview left: towards the tightest raw bound ahead
    STALE = 4  # measurement timed out: assumed to be closer than last measured
