"""The recorder's bag: every topic and type, readable without ROS, also after a kill."""

from __future__ import annotations

import resource
import signal
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bridge_client import DEADLINE, EXIT, ROBOT, BridgeClient, GravityModel
from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import ControllerState, NamedCount, PriorityMatrix, PriorityTransition, TaskState
from mcap.reader import make_reader
from mcap.records import Channel, Message
from mcap_ros2.decoder import DecoderFactory
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from ghc_controller.errors import ConfigurationError
from ghc_controller.ros.qos import CONTROL_PUBLISHER_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_controller.ros.wire.cdr import read_stamp
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.recorder.bag_reading import intact_records, raw_messages
from ghc_sim_bridge.ros.message_schema import message_class, message_schema
from ghc_sim_bridge.ros.recorder_node import is_fast

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
STEPS = 100  # [-] control periods of 1 ms


@pytest.fixture
def client(ros_context: Any) -> Iterator[BridgeClient]:
    """The bridge's partner on the test's own domain."""
    partner = BridgeClient(ros_context)
    yield partner
    partner.close()


class Recording:
    """What a file holds, decoded by its own schemas."""

    def __init__(self, path: Path) -> None:
        with (path / f"{path.name}_0.mcap").open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            self.profile = reader.get_header().profile
            self.messages: dict[str, list[Any]] = {}
            self.types: dict[str, str] = {}
            self.log_times: dict[str, list[int]] = {}
            for schema, channel, message, decoded in reader.iter_decoded_messages():
                self.types[channel.topic] = schema.name
                self.messages.setdefault(channel.topic, []).append(decoded)
                self.log_times.setdefault(channel.topic, []).append(message.log_time)

    def stamps(self, topic: str) -> list[int]:
        """Stamps [ns] of a topic."""
        headers = [message.header.stamp for message in self.messages[topic]]
        return [stamp.sec * 1_000_000_000 + stamp.nanosec for stamp in headers]


def _start(start_node: Callable[..., Any], executable: str, **parameters: object) -> Any:
    pairs = [part for k, v in parameters.items() for part in ("-p", f"{k}:={v}")]
    return start_node("ghc_sim_bridge", executable, "--ros-args", *pairs)


def _on_disk(folder: Path, topic: str) -> int:
    """Messages of a topic in a bag that is being written."""
    channels: dict[int, str] = {}
    count = 0
    file = folder / f"{folder.name}_0.mcap"
    if not file.is_file():  # the recorder has a topic before it has a file
        return 0
    for record in intact_records(file):
        if isinstance(record, Channel):
            channels[record.id] = record.topic
        elif isinstance(record, Message):
            count += channels[record.channel_id] == topic
    return count


def _newest_on_disk(folder: Path, topic: str) -> float:
    """Stamp [s] of the last message of a topic in a bag that is being written; -1 without one."""
    if not (folder / f"{folder.name}_0.mcap").is_file():
        return -1.0
    found = [m.data for t, m in raw_messages(folder) if m is not None and t.name == topic]
    return read_stamp(found[-1]) / NANOSECONDS if found else -1.0


def _readers(client: BridgeClient, topic: str) -> int:
    return int(client.node.count_subscribers(topic))


def _record_a_walk(
    start_node: Callable[..., Any], client: BridgeClient, path: Path, mode: str
) -> Recording:
    """A walk of the arm, with messages of the stack's own types, under the recorder's eyes."""
    node = client.node
    matrix = node.create_publisher(PriorityMatrix, "ghc/priority_matrix", LATCHED)
    matrix.publish(PriorityMatrix(tasks=["a", "b"], alpha=[0.0, 1.0, 0.0, 0.0], hierarchy="b > a"))
    transition = node.create_publisher(PriorityTransition, "ghc/priority_transition", STEPS)
    state = node.create_publisher(ControllerState, "ghc/controller_state", STEPS)
    wrench = node.create_publisher(WrenchStamped, "contacts/extra", CONTROL_PUBLISHER_QOS)
    recorder = _start(start_node, "recorder", output=path, record_mode=mode)
    lossless = "true" if mode == "full" else "false"
    _start(start_node, "sim_bridge", scene=ROBOT, lossless=lossless, paused="true")
    for topic, readers in (
        ("ghc/priority_transition", 1), ("ghc/controller_state", 1), ("contacts/extra", 1),
        ("joint_commands", 2), ("joint_states", 2), ("/clock", 1), ("/diagnostics", 2),
    ):  # fmt: skip
        client.until(lambda: _readers(client, topic) >= readers, f"readers of {topic}")  # noqa: B023
    for publisher in (transition, state, wrench):
        client.until(publisher.get_subscription_count, f"readers of {publisher.topic_name}")
    client.until(lambda: client.commands.get_subscription_count() >= 2, "readers of commands")
    # The bridge hears of the recorder later than we do; it repeats its state.
    client.until(lambda: _on_disk(path, "/joint_states"), "the first state on the disk")
    model = GravityModel()
    client.pause(False)
    robot = client.connected_state()
    for k in range(STEPS):
        stamp = robot.header.stamp
        report = ControllerState(formulation="balanced", alpha=[0.5, 0.5, 0.5, 0.5])
        report.header.stamp = stamp
        report.tasks = [TaskState(name="a", error=[0.1 * k, 0.0, 0.0], error_norm=0.1 * k)]
        report.counts = [NamedCount(name="qp_failures", count=k)]
        state.publish(report)
        push = WrenchStamped()
        push.header.stamp = stamp
        push.wrench.force.z = float(k)
        wrench.publish(push)
        transition.publish(PriorityTransition(id=str(k), hierarchy="a > b", duration=2.0))
        robot = client.step(robot, model.swing(robot))
    client.diagnostics.clear()
    client.until(lambda: client.diagnostics, "the diagnostics")
    client.until(
        lambda: (
            _on_disk(path, "/ghc/priority_transition") == STEPS
            and _on_disk(path, "/diagnostics") > 0
        ),
        "the last messages on the disk",
    )
    recorder.send(signal.SIGINT)
    assert recorder.wait() == 0
    assert "Traceback" not in recorder.output
    return Recording(path)


def test_decimated_recording(
    start_node: Callable[..., Any], client: BridgeClient, tmp_path: Path
) -> None:
    recording = _record_a_walk(start_node, client, tmp_path / "new" / "run", "decimated")
    assert recording.profile == "ros2"
    expected = {
        "/clock": "rosgraph_msgs/msg/Clock",
        "/contacts/extra": "geometry_msgs/msg/WrenchStamped",
        "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
        "/ghc/controller_state": "ghc_msgs/msg/ControllerState",
        "/ghc/priority_matrix": "ghc_msgs/msg/PriorityMatrix",
        "/ghc/priority_transition": "ghc_msgs/msg/PriorityTransition",
        "/joint_commands": "sensor_msgs/msg/JointState",
        "/joint_states": "sensor_msgs/msg/JointState",
    }
    assert {topic: recording.types.get(topic) for topic in expected} == expected
    transitions = recording.messages["/ghc/priority_transition"]
    assert [message.id for message in transitions] == [str(k) for k in range(STEPS)]
    (matrix,) = recording.messages["/ghc/priority_matrix"]
    assert (matrix.hierarchy, list(matrix.alpha)) == ("b > a", [0.0, 1.0, 0.0, 0.0])
    for topic in ("/joint_states", "/joint_commands", "/ghc/controller_state", "/contacts/extra"):
        grid = [stamp for stamp in recording.stamps(topic) if stamp % 10_000_000 == 0]
        assert recording.stamps(topic) == grid, "one message per 10 ms, on the grid"
        assert len(grid) >= STEPS // 10 - 1
    report = recording.messages["/ghc/controller_state"][-1]
    assert report.tasks[0].error_norm == pytest.approx(0.1 * report.counts[0].count)
    assert max(recording.log_times["/ghc/priority_transition"]) <= STEPS * 1_000_000
    names = {path.name for path in (tmp_path / "new" / "run").iterdir()}
    assert names == {"run_0.mcap", "metadata.yaml"}
    with Reader(tmp_path / "new" / "run") as reader:
        hashes = {c.topic: c.digest.partition("_")[0] for c in reader.connections}
        latched: Any = {c.topic: c.ext for c in reader.connections}["/ghc/priority_matrix"]
    assert set(hashes) >= set(recording.types)
    assert set(hashes.values()) == {"RIHS01"}
    (qos,) = latched.offered_qos_profiles
    assert qos.durability.name == "TRANSIENT_LOCAL"


def test_full_recording_has_every_state(
    start_node: Callable[..., Any], client: BridgeClient, tmp_path: Path
) -> None:
    """Of a bridge with `lossless`; who publishes without that may lose messages on the way."""
    recording = _record_a_walk(start_node, client, tmp_path / "run", "full")
    steps = [k * 1_000_000 for k in range(STEPS + 1)]
    assert sorted(set(recording.stamps("/joint_states"))) == steps
    assert set(recording.stamps("/joint_commands")) <= set(steps)
    walked = {
        stamp: np.array(message.position)
        for stamp, message in zip(
            recording.stamps("/joint_states"), recording.messages["/joint_states"], strict=True
        )
    }
    assert np.abs(walked[steps[-1]] - walked[0]).max() > 1e-4


def test_recording_without_a_clock_runs_on_wall_time(
    start_node: Callable[..., Any], client: BridgeClient, tmp_path: Path
) -> None:
    recorder = _start(start_node, "recorder", output=tmp_path / "run")
    transition = client.node.create_publisher(PriorityTransition, "ghc/priority_transition", 10)
    client.until(lambda: transition.get_subscription_count() > 0, "the recorder")
    now = client.node.get_clock().now().nanoseconds
    message = PriorityTransition(id="by hand")
    message.header.stamp = time_from_nanoseconds(now)
    transition.publish(message)
    client.until(
        lambda: _on_disk(tmp_path / "run", "/ghc/priority_transition"),
        "the message",
        again=lambda: transition.publish(message),
    )
    assert recorder.stop() == 0
    end = client.node.get_clock().now().nanoseconds
    log_times = Recording(tmp_path / "run").log_times["/ghc/priority_transition"]
    assert now <= min(log_times) <= max(log_times) <= end


def test_a_run_that_is_killed_at_9_s_opens_with_rosbags_up_to_8_s(
    start_node: Callable[..., Any], client: BridgeClient, tmp_path: Path
) -> None:
    """Without a repair; the robot is held by the watchdog, in real time, at 1 kHz."""
    recorder = _start(start_node, "recorder", output=tmp_path / "run", record_mode="full")
    _start(start_node, "sim_bridge", scene=ROBOT, mode="realtime")
    client.until(lambda: _readers(client, "joint_states") >= 2, "readers of joint_states")
    client.until(lambda: _on_disk(tmp_path / "run", "/joint_states"), "the first states on disk")

    def now() -> float:
        return nanoseconds_from_time(client.connected_state().header.stamp) / NANOSECONDS

    began = now()
    end = max(9.0, began + 2.0)  # on a loaded machine discovery may take seconds
    client.until(lambda: now() >= end, f"{end:g} s of simulated time")
    # However late it is on a loaded machine: at most 1 s of it is missing when it is killed.
    written = -np.inf

    def is_up_to_date() -> bool:
        nonlocal written
        sent = now()
        written = _newest_on_disk(tmp_path / "run", "/joint_states")
        return written >= sent - 1.0

    client.until(is_up_to_date, "the states on the disk")
    recorder.send(signal.SIGKILL)
    assert recorder.wait() == -signal.SIGKILL
    stamps = []
    with AnyReader([tmp_path / "run"]) as reader:
        chosen = [c for c in reader.connections if c.topic == "/joint_states"]
        for connection, _, data in reader.messages(connections=chosen):
            state: Any = reader.deserialize(data, connection.msgtype)
            stamps.append(nanoseconds_from_time(state.header.stamp) / NANOSECONDS)
    assert stamps[0] <= began
    assert stamps[-1] >= written >= end - 1.0
    assert np.diff(stamps).max() < 0.5


def test_a_full_disk_ends_the_recording_and_not_the_run(
    start_node: Callable[..., Any], client: BridgeClient, tmp_path: Path
) -> None:
    """The file may not grow beyond a limit, which the system reports as a full disk."""
    recorder = _start(start_node, "recorder", output=tmp_path / "run")
    resource.prlimit(recorder.pid, resource.RLIMIT_FSIZE, (64 * 1024, 64 * 1024))
    transition = client.node.create_publisher(PriorityTransition, "ghc/priority_transition", 5000)
    client.until(lambda: transition.get_subscription_count() > 0, "the recorder")
    first = PriorityTransition(id="0")
    client.until(
        lambda: _on_disk(tmp_path / "run", "/ghc/priority_transition"),
        "the first message on the disk",
        again=lambda: transition.publish(first),
    )
    rng = np.random.default_rng(1)
    sent = 1
    deadline = time.monotonic() + DEADLINE
    while "recording ends here, the run goes on" not in recorder.output:
        assert time.monotonic() < deadline
        noise = rng.bytes(500).hex()  # 2 to 1 is all that compression finds
        transition.publish(PriorityTransition(id=str(sent), hierarchy=noise))
        sent += 1
        client.spin(0.01)
    assert str(tmp_path / "run" / "run_0.mcap") in recorder.output
    for _ in range(50):
        transition.publish(PriorityTransition(id="later"))
        client.spin(0.01)
    assert recorder.exit_code is None, "the node stays for those that wait for it"
    assert recorder.stop() == 1
    assert recorder.output.count("recording ends here") == 1
    with AnyReader([tmp_path / "run"]) as reader:
        chosen = [c for c in reader.connections if c.topic == "/ghc/priority_transition"]
        messages: list[Any] = [
            reader.deserialize(data, connection.msgtype)
            for connection, _, data in reader.messages(connections=chosen)
        ]
    kept = [message.id for message in messages]
    kept = kept[kept.count("0") - 1 :]  # the first one may have been sent again
    assert kept == [str(k) for k in range(len(kept))]
    assert 20 < len(kept) < sent


def test_bytes_that_are_no_message_do_not_end_the_recorder(
    start_node: Callable[..., Any], client: BridgeClient, tmp_path: Path
) -> None:
    recorder = _start(start_node, "recorder", output=tmp_path / "run")
    state = client.node.create_publisher(ControllerState, "ghc/controller_state", 10)
    client.until(lambda: state.get_subscription_count() > 0, "the recorder")
    for message in (b"\x00\x01\x00\x00", ControllerState(formulation="balanced")):
        before = _on_disk(tmp_path / "run", "/ghc/controller_state")
        state.publish(message)
        client.until(
            lambda: _on_disk(tmp_path / "run", "/ghc/controller_state") > before,  # noqa: B023
            "the message on the disk",
            again=lambda: state.publish(message),  # noqa: B023
        )
    assert recorder.stop() == 0
    with Reader(tmp_path / "run") as reader:
        sizes = [
            len(data) for c, _, data in reader.messages() if c.topic == "/ghc/controller_state"
        ]
    assert sizes[0] == 4 and sizes[-1] > 4


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({}, ["'output'", "is needed"]),
        ({"output": "/dev/null/run"}, ["/dev/null"]),
        ({"output": "results/run.mcap"}, ["'output' is a folder", "results/run"]),
        ({"output": "run", "record_mode": "some"}, ["'record_mode'", "decimated, full"]),
    ],
)
def test_what_cannot_be_used_is_one_clear_line(
    start_node: Callable[..., Any], parameters: dict[str, str], words: list[str]
) -> None:
    recorder = _start(start_node, "recorder", **parameters)
    assert recorder.wait(EXIT) == 2
    (line,) = recorder.output.strip().splitlines()
    assert all(word in line for word in ["recorder: ", *words])


def contained(kind: str) -> set[str]:
    """Messages inside a message, `package/Name`, of all depths."""
    found: set[str] = set()
    package, _, name = kind.split("/")
    message = getattr(import_module(f"{package}.msg"), name)
    for text in message.get_fields_and_field_types().values():
        name = text.removeprefix("sequence<").split(",")[0].rstrip(">").split("[")[0]
        if "/" in name:
            found |= {name} | contained(name.replace("/", "/msg/"))
    return found


def test_schema_holds_every_inner_message_once() -> None:
    kind = "ghc_msgs/msg/ControllerState"
    lines = message_schema(kind).splitlines()
    inner = [line.removeprefix("MSG: ") for line in lines if line.startswith("MSG: ")]
    assert sorted(inner) == sorted(contained(kind))
    assert {"ghc_msgs/TaskState", "ghc_msgs/RowState", "std_msgs/Header"} <= set(inner)


@pytest.mark.parametrize(
    ("topic", "fast"),
    [
        ("/joint_states", True), ("/left/joint_commands", True), ("/clock", True),
        ("/contacts/tool", True), ("/left/contacts/tool", True), ("/ghc/controller_state", True),
        ("/ghc/priority_matrix", False), ("/contacts", False), ("/diagnostics", False),
    ],
)  # fmt: skip
def test_fast_topics_are_known_by_name(topic: str, fast: bool) -> None:
    assert is_fast(topic) is fast


@pytest.mark.parametrize("name", ["Frame", "vendor/idl/msg/Frame", "", "//", "..//Frame"])
def test_a_type_of_another_middleware_is_an_error_that_names_it(name: str) -> None:
    """Participants without ROS have types of any name; a topic of theirs ends no recording."""
    for read in (message_class, message_schema):
        with pytest.raises(ConfigurationError, match=f"message type '{name}'"):
            read(name)
