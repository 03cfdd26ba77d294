"""A recorded run over DDS again: the same joint states in the same order, with /clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ghc_msgs.msg import PriorityMatrix
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from ghc_controller.ros.qos import LATCHED_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_recording import BagRecording
from ghc_sim_bridge.ros.message_schema import message_schema

STATES = 400  # [-] of 5 ms
STEP = 5_000_000  # [ns]
LAST = (STATES - 1) * STEP  # [ns]
EVERY = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
DEADLINE = 90.0  # [s] wall


def record(folder: Path) -> tuple[list[JointState], BagRecording]:
    """Random joint states with /clock, and a latched matrix at the start; not closed yet."""
    rng = np.random.default_rng(7)
    recording = BagRecording(folder)
    latched = ({"durability": "transient_local", "reliability": "reliable", "depth": 1},)
    for name, kind, qos in (
        ("/joint_states", "sensor_msgs/msg/JointState", ()),
        ("/clock", "rosgraph_msgs/msg/Clock", ()),
        ("/ghc/priority_matrix", "ghc_msgs/msg/PriorityMatrix", latched),
    ):
        recording.add_topic(BagTopic(name, kind, message_schema(kind), qos))
    matrix = PriorityMatrix(tasks=["a"], alpha=[0.0], hierarchy="a")
    recording.write("/ghc/priority_matrix", 0, 0, serialize_message(matrix))
    states = []
    for k in range(STATES):
        stamp = time_from_nanoseconds(k * STEP)
        state = JointState(name=["one", "two"], position=rng.standard_normal(2).tolist())
        state.header.stamp = stamp
        states.append(state)
        recording.write("/clock", k * STEP, k, serialize_message(Clock(clock=stamp)))
        recording.write("/joint_states", k * STEP, k, serialize_message(state))
    return states, recording


class Listener:
    """Keeps what it hears."""

    def __init__(self, context: Any) -> None:
        self.node = Node("listener", context=context)
        self.states: list[JointState] = []
        self.clock: list[int] = []
        self.matrices: list[PriorityMatrix] = []
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.node.create_subscription(JointState, "joint_states", self.states.append, EVERY)
        self.node.create_subscription(Clock, "/clock", self._on_clock, EVERY)

    def _on_clock(self, message: Clock) -> None:
        self.clock.append(nanoseconds_from_time(message.clock))

    def late_reader(self) -> None:
        """Listen to the latched topic from now on."""
        self.node.create_subscription(
            PriorityMatrix, "ghc/priority_matrix", self.matrices.append, LATCHED_QOS
        )

    def until(self, condition: Callable[[], Any]) -> None:
        """Spin until `condition`."""
        deadline = time.monotonic() + DEADLINE
        while not condition():
            self._executor.spin_once(timeout_sec=0.05)
            assert time.monotonic() < deadline, f"{len(self.states)} states came"

    def spin(self, seconds: float) -> None:
        """Spin for `seconds` [s] of wall time."""
        end = time.monotonic() + seconds
        self.until(lambda: time.monotonic() > end)

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self.node.destroy_node()


@pytest.fixture
def listener(ros_context: Any) -> Iterator[Listener]:
    """Someone who listens before the replay begins."""
    found = Listener(ros_context)
    yield found
    found.close()


def replay(start_node: Callable[..., Any], path: Path, **parameters: object) -> Any:
    values = {"recording": path, "delay": 6.0, **parameters}
    pairs = [part for name, value in values.items() for part in ("-p", f"{name}:={value}")]
    return start_node("ghc_sim_bridge", "replay", "--ros-args", *pairs)


def test_replayed_joint_states_are_the_recorded_ones_in_their_order(
    start_node: Callable[..., Any], listener: Listener, tmp_path: Path
) -> None:
    states, recording = record(tmp_path / "run")
    recording.close()
    node = replay(start_node, tmp_path / "run", rate=0.5)
    listener.until(lambda: len(listener.states) >= 10)
    began = time.monotonic()
    listener.late_reader()
    listener.until(lambda: listener.states[-1] == states[-1] and listener.clock[-1] == LAST)
    assert time.monotonic() - began > 0.3, "seconds of the recording at half its rate"
    check_heard(listener, states)
    assert node.wait() == 0, node.output
    assert [matrix.hierarchy for matrix in listener.matrices] == ["a"]


def check_heard(listener: Listener, states: list[JointState]) -> None:
    """All from the first one that was heard: what comes before its discovery is lost."""
    heard = listener.states
    assert 10 <= len(heard) <= len(states)
    assert heard == states[-len(heard) :]
    assert listener.clock == sorted(set(listener.clock))
    assert set(listener.clock) <= {k * STEP for k in range(STATES)}


def test_a_cut_recording_is_played_up_to_there_with_a_clock_of_its_own(
    start_node: Callable[..., Any], listener: Listener, tmp_path: Path
) -> None:
    states, recording = record(tmp_path / "run")
    recording.checkpoint()
    recording.abandon()
    file = recording.path
    file.write_bytes(file.read_bytes()[:-20])
    node = replay(start_node, file, rate=10.0, start=1.0, topics="[joint_states]")
    assert node.wait(DEADLINE) == 0, node.output
    listener.until(lambda: listener.states[-1:] == states[-1:])
    listener.spin(0.5)
    check_heard(listener, states)
    assert len(listener.states) <= STATES // 2, "from `start` on"
    # As /clock is sent as best effort, some of it may be lost.
    assert set(listener.clock) <= {k * STEP for k in range(STATES // 2, STATES)}


def test_a_loop_goes_on_until_a_signal(
    start_node: Callable[..., Any], listener: Listener, tmp_path: Path
) -> None:
    states, recording = record(tmp_path / "run")
    recording.close()
    # At a rate at which its queue of 1000 messages bridges a pause of this reader.
    node = replay(start_node, tmp_path / "run", rate=2.0, loop="true")
    listener.until(lambda: len(listener.states) > 2 * STATES)
    assert node.stop() == 0
    heard = listener.states
    first = states.index(heard[0])
    assert all(heard[k] == states[(first + k) % STATES] for k in range(2 * STATES))


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"recording": "nothing.mcap"}, ["nothing.mcap"]),
        ({"rate": 0.0}, ["'rate'", "a number in [0.001, 1000] expected, 0"]),
        ({"start": 9.0}, ["'start'", "9 s given", "lasts 1.995 s"]),
        ({"topics": "[odom]"}, ["'/odom'", "known: /joint_states"]),
    ],
)
def test_what_cannot_be_used_is_one_clear_line(
    start_node: Callable[..., Any], tmp_path: Path, parameters: dict[str, Any], words: list[str]
) -> None:
    record(tmp_path / "run")[1].close()
    path = tmp_path / str(parameters.pop("recording", "run"))
    node = replay(start_node, path, **parameters)
    assert node.wait(DEADLINE) == 2
    line = node.output.strip().splitlines()[-1]
    assert all(word in line for word in ["replay: ", *words])
