"""How a row of a preview came about."""

from __future__ import annotations

from enum import Enum


class PreviewStatus(Enum):
    """How a row of a preview came about; the value travels in messages."""

    SMOOTHED = 0  # the optimum of the preview
    RAW = 1  # as given: smoothing off, or an obstacle outside its safe distance
    HELD = 2  # no solution: the preview before, as far as it goes, inside the raw bounds
    TIGHTENED = 3  # no solution and no preview left: towards the tightest raw bound ahead
    STALE = 4  # no measurement for too long: taken to be closer than last seen
