"""Spinning in slices leaves nothing behind, and ends when it is told to."""

from __future__ import annotations

import gc
import time
from typing import Any

import pytest
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future

from ghc_controller.ros import run
from ghc_controller.ros.run import spin_until

SLICES = 500


@pytest.mark.parametrize("kind", [EventsExecutor, SingleThreadedExecutor])
def test_slices_leave_no_callbacks_behind(
    ros_context: Any, kind: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Hundreds were waited for; a handful is left, whatever their number."""
    monkeypatch.setattr(run, "SPIN_SLICE", 1e-4)
    node = Node("spinner", context=ros_context)
    executor = kind(context=ros_context)
    executor.add_node(node)
    stop, ticks = Future(), [0]

    def tick() -> None:
        ticks[0] += 1
        if ticks[0] == SLICES:
            stop.set_result(None)

    wall = Clock(clock_type=ClockType.STEADY_TIME)
    node.create_timer(1e-3, tick, clock=wall)
    gc.collect()
    before = sum(isinstance(entry, Future) for entry in gc.get_objects())
    begun = time.monotonic()
    spin_until(executor, stop)
    assert ticks[0] >= SLICES
    assert time.monotonic() - begun < 60.0
    gc.collect()
    assert sum(isinstance(entry, Future) for entry in gc.get_objects()) < before + 10
    assert len(stop._callbacks) <= 1
    executor.remove_node(node)
    executor.shutdown()
    node.destroy_node()
