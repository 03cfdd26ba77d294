"""Bytes that are no message end neither the viewer nor the node for displays."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ghc_msgs.msg import ControllerState
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from ghc_controller.ros.rejections import Rejections
from ghc_sim_bridge.ros.display.node import DisplayPublisher
from ghc_sim_bridge.ros.viewer_node import Viewer

NO_MESSAGES = [b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + bytes(8) + b"\xff" * 20]


def _node(kind: Any) -> Any:
    node = kind.__new__(kind)
    node.node = SimpleNamespace(get_logger=lambda: SimpleNamespace(warning=lambda _: None))
    node._rejections, node._floats = Rejections(), False
    return node


@pytest.mark.parametrize("data", NO_MESSAGES, ids=["short", "long"])
def test_the_viewer_shows_what_comes_after(data: bytes) -> None:
    shown: list[str] = []
    viewer = _node(Viewer)
    viewer._view = SimpleNamespace(
        show_state=lambda *_: shown.append("state"), show_report=lambda *_: shown.append("report")
    )
    viewer._odometry = b""
    viewer._state = viewer._report = data
    viewer._show()
    assert (shown, sum(viewer._rejections.counts.values())) == ([], 2)
    viewer._state = serialize_message(JointState(name=["a"], position=[0.0], effort=[0.0]))
    viewer._report = serialize_message(ControllerState())
    viewer._show()
    assert shown == ["state", "report"]


@pytest.mark.parametrize("data", NO_MESSAGES, ids=["short", "long"])
@pytest.mark.parametrize("topic", ["joint_states", "ghc/controller_state", "contacts/tool"])
def test_the_node_for_displays_goes_on(topic: str, data: bytes) -> None:
    display, drawn = _node(DisplayPublisher), list[object]()
    display._newest = {"joint_states": serialize_message(JointState(name=["a"], position=[0.0]))}
    display._newest[topic] = data
    display._shown_ns, display._joints = (-1, -1), ("a",)
    display._tree = SimpleNamespace(moving=lambda _: [])
    display._names = SimpleNamespace(message=lambda *_: SimpleNamespace(transforms=[]))
    display._tf = display._markers = SimpleNamespace(publish=lambda _: None)
    display._scenery = SimpleNamespace(message=lambda *_: drawn.append(np.nan))
    display._show()
    assert sum(display._rejections.counts.values()) == 1
    assert len(drawn) == (topic != "joint_states")
