"""Jobs beside the control cycle, one at a time."""

from __future__ import annotations

from collections.abc import Callable
from itertools import cycle

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.timer import Timer


def in_turns(node: Node, period: float, *jobs: Callable[[], None]) -> Timer:
    """Timer that calls each job once in a period [s] of the wall, evenly apart.

    Together they would take the time that a control period of 1 ms has left behind its cycle.
    """
    turns = cycle(jobs)
    wall = Clock(clock_type=ClockType.STEADY_TIME)
    return node.create_timer(period / len(jobs), lambda: next(turns)(), clock=wall)
