"""constraints/obstacles of the installed bridge: with its state, repeated with it, also empty."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from bridge_client import DEADLINE, EXIT, BridgeClient
from ghc_msgs.msg import ObstacleStateArray

from ghc_controller.ros.time import nanoseconds_from_time

SCENE = """
robot: kuka_lwr
start: {joint_2: 0.4}
camera: {look_at: [0, 0, 0.5], distance: 2, azimuth: 120, elevation: -20}
obstacle_sensor: {period: 0.01}
obstacles:
  - id: wall
    protected_frame: FRAME
    safe_distance: 0.1
    normal: [-1, 0, 0]
    track: [{time: 0.01, position: [2, 0, 0]}, {time: 0.03}]
"""
PERIOD = 10_000_000  # [ns]


@pytest.fixture
def client(ros_context: Any) -> Iterator[BridgeClient]:
    partner = BridgeClient(ros_context)
    yield partner
    partner.close()


@pytest.fixture
def arrays(client: BridgeClient) -> list[ObstacleStateArray]:
    """Everything that the sensor said, in the order in which it came."""
    kept: list[ObstacleStateArray] = []
    client.node.create_subscription(ObstacleStateArray, "constraints/obstacles", kept.append, 100)
    return kept


def _start(start_node: Callable[..., Any], folder: Path, frame: str = "tool") -> Any:
    file = folder / "walled.yaml"
    file.write_text(SCENE.replace("FRAME", frame), encoding="utf-8")
    scene = ("-p", f"scene:={file}", "-p", f"lockstep_timeout:={DEADLINE}")
    return start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *scene)


def _stamps(arrays: list[ObstacleStateArray]) -> list[int]:
    return [nanoseconds_from_time(array.header.stamp) for array in arrays]


def test_an_array_each_period_with_its_state_and_again_after_a_reset(
    start_node: Callable[..., Any],
    client: BridgeClient,
    arrays: list[ObstacleStateArray],
    tmp_path: Path,
) -> None:
    _start(start_node, tmp_path)
    state = client.connected_state()
    client.until(lambda: len(arrays) >= 3, "arrays with the repeats of the first state")
    assert set(_stamps(arrays)) == {0}
    assert all(len(array.obstacles) == 0 for array in arrays), "none is seen yet: empty arrays"
    seen = {}
    for k in range(1, 41):
        state = client.step(state, state.effort)
        if k % 10 == 0:
            client.until(lambda: _stamps(arrays)[-1] == k * 1_000_000, f"the array of {k} ms")  # noqa: B023
            seen[k] = len(arrays[-1].obstacles)
    assert seen == {10: 1, 20: 1, 30: 0, 40: 0}
    assert set(_stamps(arrays)) == {k * PERIOD for k in range(5)}, "none in between"
    entry = next(array for array in arrays if array.obstacles).obstacles[0]
    assert (entry.id, entry.protected_frame) == ("wall", "tool")
    assert list(entry.normal) == [-1.0, 0.0, 0.0]
    assert 1.0 < entry.distance < 3.0 and entry.safe_distance == 0.1
    arrays.clear()
    client.reset()
    client.until(lambda: client.epochs and client.epochs[-1].number == 1, "the next run")
    start = nanoseconds_from_time(client.epochs[-1].start)
    client.until(lambda: start in _stamps(arrays), "the array of its first state")
    first = next(array for array in arrays if nanoseconds_from_time(array.header.stamp) == start)
    assert len(first.obstacles) == 0, "the script of the scene begins again"


def test_an_unknown_frame_ends_the_bridge_with_the_known_ones(
    start_node: Callable[..., Any], tmp_path: Path
) -> None:
    bridge = _start(start_node, tmp_path, "hand")
    assert bridge.wait(EXIT) == 2
    assert "unknown frame 'hand'; known: " in bridge.output
    assert "tool" in bridge.output and "Traceback" not in bridge.output
