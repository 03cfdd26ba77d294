"""The installed bridge with a robot whose base floats: odometry on the wire, hold, log, reset."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bridge_client import DEADLINE, BridgeClient
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from ghc_controller.ros.conversions.states import base_from_bytes
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_sim_bridge.logs.full_rate_log import FullRateLog, Source
from ghc_sim_bridge.simulation.simulator import Simulator

SCENE = "icub_standing"
StartBridge = Callable[..., Any]


@pytest.fixture
def start_bridge(start_node: Callable[..., Any]) -> StartBridge:
    """Start the bridge, parameters by keyword; `make test` installs the robot's model."""

    def start(**parameters: object) -> Any:
        pairs = ({"scene": SCENE, "lockstep_timeout": DEADLINE} | parameters).items()
        arguments = [part for name, value in pairs for part in ("-p", f"{name}:={value}")]
        return start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *arguments)

    return start


class Listener(BridgeClient):
    """Notes odometry, and how often each stamp came."""

    def __init__(self, context: Any) -> None:
        super().__init__(context)
        self.seen: list[tuple[str, int]] = []
        self.odometry: dict[int, Odometry] = {}
        self.node.create_subscription(Odometry, "odom", self._on_odom, CONTROL_SUBSCRIBER_QOS)
        self.node.create_subscription(
            JointState, "joint_states", self._on_state, CONTROL_SUBSCRIBER_QOS
        )

    def _on_odom(self, message: Odometry) -> None:
        stamp = nanoseconds_from_time(message.header.stamp)
        self.seen.append(("odom", stamp))
        self.odometry[stamp] = message

    def _on_state(self, message: JointState) -> None:
        self.seen.append(("joint_states", nanoseconds_from_time(message.header.stamp)))

    def odometry_of(self, state: JointState) -> Odometry:
        """The odometry with a state's stamp."""
        stamp = nanoseconds_from_time(state.header.stamp)
        self.until(lambda: stamp in self.odometry, f"odometry of {stamp} ns")
        return self.odometry[stamp]


@pytest.fixture
def client(ros_context: Any) -> Iterator[Listener]:
    partner = Listener(ros_context)
    yield partner
    partner.close()


def test_every_state_has_the_odometry_of_its_base(
    start_bridge: StartBridge, client: Listener, tmp_path: Path
) -> None:
    file = tmp_path / "log.npz"
    node = start_bridge(log_file=file, stop_time=0.05)
    twin = Simulator(SCENE)
    state = client.connected_state()
    effort = np.array(state.effort)
    assert tuple(state.name) == twin.joint_names
    assert effort == pytest.approx(twin.torque, abs=1e-9)  # what carries it at the start
    for _ in range(30):
        odometry = client.odometry_of(state)
        pose, twist = np.split(base_from_bytes(serialize_message(odometry)), [7])
        here = twin.state()
        assert (odometry.header.frame_id, state.header.frame_id) == ("world", "")
        assert odometry.child_frame_id == twin.base_frame
        assert pose == pytest.approx(here.q[:7], abs=1e-9)
        assert twist == pytest.approx(here.v[:6], abs=1e-6)
        assert list(state.position) == pytest.approx(here.q[7:], abs=1e-9)
        state = client.step(state, effort)
        twin.step(effort)
    client.odometry_of(state)
    assert node.stop() == 0
    log = FullRateLog.load(file)
    assert log.base_pose is not None and log.base_velocity is not None
    assert log.base_pose[0] == pytest.approx(twin.start[:7])
    assert log.base_velocity[0] == pytest.approx(np.zeros(6))
    assert log.configuration(0) == pytest.approx(twin.start)
    assert log.velocity(0).shape == (twin.nv,)
    assert set(log.source[:30]) == {Source.COMMAND}


def test_an_unanswered_state_is_repeated_with_its_odometry(
    start_bridge: StartBridge, client: Listener
) -> None:
    start_bridge()
    client.connected_state()
    client.seen.clear()
    client.until(lambda: client.seen.count(("odom", 0)) >= 3, "repeated odometry")
    client.until(lambda: client.seen.count(("joint_states", 0)) >= 2, "repeated states")


def test_a_reset_puts_the_base_back_in_the_next_epoch(
    start_bridge: StartBridge, client: Listener
) -> None:
    start_bridge()
    state = client.connected_state()
    for _ in range(20):
        state = client.step(state, np.zeros(len(state.name)))  # it sinks
    sunk = base_from_bytes(serialize_message(client.odometry_of(state)))[:7]
    client.odometry.clear()
    assert client.reset().startswith("epoch 1 ")
    start_ns = 2_000_000_000
    client.until(lambda: start_ns in client.odometry, "the next epoch")
    pose, twist = np.split(base_from_bytes(serialize_message(client.odometry[start_ns])), [7])
    start = Simulator(SCENE).start
    assert np.abs(sunk - start[:7]).max() > 1e-4
    assert pose == pytest.approx(start[:7], abs=1e-9)
    assert twist == pytest.approx(np.zeros(6), abs=1e-9)


def test_without_a_controller_it_is_held_standing(
    start_bridge: StartBridge, client: Listener, tmp_path: Path
) -> None:
    """In realtime nobody answers: a second later it stands as it stood, and at rest."""
    file = tmp_path / "log.npz"
    node = start_bridge(mode="realtime", control_dt=0.004, log_file=file)
    client.connected_state()
    client.until(lambda: max(client.odometry, default=0) > 1_000_000_000, "a second")
    assert node.stop() == 0
    log = FullRateLog.load(file)
    assert set(log.source) == {Source.HOLD}
    assert log.base_pose is not None
    assert np.abs(log.base_pose[-1] - log.base_pose[0]).max() < 0.01
    assert np.abs(log.v[-1]).max() < 0.05
