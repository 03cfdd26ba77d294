"""Jobs beside the control cycle do not run in one go."""

from __future__ import annotations

import time
from typing import Any

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from ghc_controller.ros.process.in_turns import in_turns

PATIENCE = 60.0  # [s] wall


def test_jobs_take_turns_and_no_call_of_the_timer_does_two(ros_context: Any) -> None:
    node = Node("worker", context=ros_context)
    done: list[str] = []
    timer = in_turns(node, 0.03, lambda: done.append("a"), lambda: done.append("b"))
    assert timer.timer_period_ns == 15_000_000
    executor = SingleThreadedExecutor(context=ros_context)
    executor.add_node(node)
    deadline = time.monotonic() + PATIENCE
    while len(done) < 6 and time.monotonic() < deadline:
        before = len(done)
        executor.spin_once(timeout_sec=1.0)
        assert len(done) <= before + 1
    assert done == ["a", "b"] * 3
    executor.shutdown()
    node.destroy_node()
