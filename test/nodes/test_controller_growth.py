"""What the controller node holds does not grow with states, transitions and diagnostics.

CPython keeps the names of attributes that were looked up last, at most 4096 of them, and messages
are converted with names made anew: up to 0.25 MB, reached after minutes. That cache is emptied
before memory is compared.
"""

from __future__ import annotations

import gc
import sys
import tracemalloc

import numpy as np
import pytest
import rclpy
from rclpy.task import Future

from ghc_controller.ros.controller_node import ControllerNode
from ghc_controller.ros.wire.joint_state import JointStateValues

Q = np.array([0.3, 0.7, -0.4, 1.1, 0.5, -0.6, 0.2])  # [rad]
ORDERS = ("end_effector > elbow > posture", "elbow > end_effector > posture")
PHASES = np.arange(7.0)


def _ticks(node: ControllerNode, ticks: range) -> None:
    names = node._controller.model.joint_names
    for k in ticks:
        angle = 3e-3 * k + PHASES
        q, v = Q + 0.01 * np.sin(angle), 0.03 * np.cos(angle)
        values = JointStateValues((k + 1) * 1_000_000, "", names, q, v, np.zeros(7))
        node.answer(values, new_epoch=k == 0)
        if k % 100 == 0:
            node._controller.change_hierarchy(ORDERS[k // 100 % 2], duration=0.05)
            node._publish_diagnostics()
            node._look_for_old_clients()


def _held() -> int:
    """Bytes that Python holds, garbage and names in the cache of attributes aside."""
    sys._clear_type_cache()
    gc.collect()
    return tracemalloc.get_traced_memory()[0]


@pytest.mark.parametrize("mode", ["lockstep", "real time"])
def test_memory_does_not_grow_with_ticks(ros_domain_id: int, mode: str) -> None:
    lockstep = str(mode == "lockstep").lower()
    arguments = ["--ros-args", "-p", "robot:=kuka_lwr", "-p", f"lockstep:={lockstep}"]
    rclpy.init(args=["test", *arguments], domain_id=ros_domain_id)
    try:
        node = ControllerNode(Future())
        _ticks(node, range(1000))
        tracemalloc.start()
        try:
            _ticks(node, range(1000, 3000))
            before = _held()
            _ticks(node, range(3000, 13000))
            grown = _held() - before
        finally:
            tracemalloc.stop()
        node.close()
        node.node.destroy_node()
    finally:
        rclpy.shutdown()
    assert grown < 20_000  # [B] 2 a tick, where a number that is kept would be 24
