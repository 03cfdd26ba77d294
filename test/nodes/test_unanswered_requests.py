"""A service that does not answer costs the page of `steer` no memory."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest
from rcl_interfaces.srv import GetParameters
from rclpy.context import Context
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from ghc_controller.ros.steering.node import GAINS_SERVICE, ask

PATIENCE = 60.0  # [s] wall


@pytest.fixture
def spun(ros_context: Context) -> Any:
    """Two nodes, a client and a service, and what lets the service answer."""
    asking, answering = Node("asking", context=ros_context), Node("answering", context=ros_context)
    free = threading.Event()

    def serve(_: Any, response: Any) -> Any:
        free.wait(PATIENCE)
        return response

    answering.create_service(GetParameters, GAINS_SERVICE, serve)
    client = asking.create_client(GetParameters, GAINS_SERVICE)
    executor = MultiThreadedExecutor(2, context=ros_context)
    for node in (asking, answering):
        executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    assert client.wait_for_service(PATIENCE)
    yield client, free.set
    free.set()
    executor.shutdown()
    thread.join(PATIENCE)
    for node in (asking, answering):
        node.destroy_node()


def test_requests_without_an_answer_are_forgotten(
    spun: tuple[Any, Callable[[], None]],
) -> None:
    """And a late answer to one of them disturbs no later request."""
    client, answer = spun
    for _ in range(20):
        assert ask(client, GetParameters.Request(), within=0.01) is None
    assert not client._pending_requests
    answer()
    assert ask(client, GetParameters.Request(), within=PATIENCE) is not None
    assert not client._pending_requests
