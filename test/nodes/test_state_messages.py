"""The bridge's own CDR writer says exactly what the message classes say."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from ghc_controller.errors import InvalidValue
from ghc_controller.ros.conversions.states import (
    base_from_bytes,
    read_joint_state,
    wrench_from_bytes,
)
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_controller.ros.wire.cdr import read_stamp
from ghc_controller.ros.wire.joint_state import (
    JointStateDecoder,
    JointStateEncoder,
    JointStateLayout,
    JointStateValues,
)
from ghc_controller.ros.wire.joint_state_reader import JointStateReader
from ghc_controller.types import RobotState
from ghc_sim_bridge.bridge.state_cdr import OdometryEncoder, WrenchEncoder, encode_clock

STAMPS = (0, 1, 999_999_999, 1_000_000_000, 12_345_678_901_234)  # [ns]


def _message(
    stamp_ns: int, frame_id: str, names: list[str], numbers: list[np.ndarray]
) -> JointState:
    message = JointState(name=names)
    message.header.stamp = time_from_nanoseconds(stamp_ns)
    message.header.frame_id = frame_id
    message.position, message.velocity, message.effort = (list(map(float, x)) for x in numbers)
    return message


def _same_but_for_padding(written: bytes, message: JointState, layout: JointStateLayout) -> bool:
    """The message class leaves whatever is in memory between fields, so bytes may differ there."""
    return layout.describes(bytes(serialize_message(message))) and (
        deserialize_message(written, JointState) == message
    )


@pytest.mark.parametrize("seed", range(20))
def test_joint_state_is_that_of_the_message_class(seed: int) -> None:
    """Whatever the lengths of the names and so the alignment of the numbers."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(0, 9))
    names = ["j" * int(rng.integers(0, 12)) + str(k) for k in range(count)]
    frame_id = "9" * int(rng.integers(0, 6))
    encoder = JointStateEncoder(names, frame_id)
    layout = JointStateLayout(frame_id, names, count, count, count)
    for _ in range(3):
        numbers = [rng.normal(size=count) for _ in range(3)]
        stamp = int(rng.integers(0, 10**12))
        written = encoder.encode(stamp, numbers[2], *numbers[:2])
        assert _same_but_for_padding(written, _message(stamp, frame_id, names, numbers), layout)
        assert read_stamp(written) == stamp


@pytest.mark.parametrize("lengths", [(0, 0, 7), (7, 0, 7), (3, 2, 1), (0, 0, 0)])
def test_layout_with_empty_sequences(lengths: tuple[int, int, int]) -> None:
    names = [f"joint_{k}" for k in range(7)]
    layout = JointStateLayout("0", names, *lengths)
    numbers = [np.zeros(count) for count in lengths]
    assert _same_but_for_padding(bytes(layout.data), _message(0, "0", names, numbers), layout)


def test_layout_tells_other_messages_apart() -> None:
    layout = JointStateLayout("0", ["a", "b"], 2, 0, 2)
    for frame_id, names, counts in (
        ("1", ["a", "b"], (2, 0, 2)),
        ("0", ["a", "c"], (2, 0, 2)),
        ("0", ["a", "b"], (0, 2, 2)),
        ("0", ["a", "b"], (2, 0, 1)),
    ):
        numbers = [np.zeros(count) for count in counts]
        assert not layout.describes(serialize_message(_message(0, frame_id, names, numbers)))


def test_joint_state_refuses_arrays_of_another_size() -> None:
    encoder = JointStateEncoder(["a", "b"], "0")
    with pytest.raises(ValueError, match="broadcast"):
        encoder.encode(0, np.zeros(3), np.zeros(2), np.zeros(2))


@pytest.mark.parametrize("stamp", STAMPS)
def test_wrench_and_clock_survive_the_wire(stamp: int) -> None:
    wrench = np.random.default_rng(stamp % 97).normal(size=6)
    message = deserialize_message(WrenchEncoder("world").encode(stamp, wrench), WrenchStamped)
    assert message.header.frame_id == "world"
    assert nanoseconds_from_time(message.header.stamp) == stamp
    np.testing.assert_array_equal(wrench_from_bytes(serialize_message(message)), wrench)
    clock = deserialize_message(encode_clock(stamp), Clock)
    assert nanoseconds_from_time(clock.clock) == stamp


@pytest.mark.parametrize("stamp", STAMPS)
def test_stamps_round_trip(stamp: int) -> None:
    assert nanoseconds_from_time(time_from_nanoseconds(stamp)) == stamp
    assert time_from_nanoseconds(1_500_000_000) == Time(sec=1, nanosec=500_000_000)


@pytest.mark.parametrize("frame_id", ["", "0", "17", "65536"])
@pytest.mark.parametrize("child", ["base", "root_link", "l"])
def test_odometry_survives_the_wire(frame_id: str, child: str) -> None:
    """Whatever the lengths of the names and so the alignment of the numbers."""
    rng = np.random.default_rng(len(frame_id) + len(child))
    encoder = OdometryEncoder(frame_id, child)
    for stamp in STAMPS:
        pose, twist = rng.normal(size=7), rng.normal(size=6)
        pose[3:] /= np.linalg.norm(pose[3:])
        message = deserialize_message(encoder.encode(stamp, pose, twist), Odometry)
        assert (message.header.frame_id, message.child_frame_id) == (frame_id, child)
        assert nanoseconds_from_time(message.header.stamp) == stamp
        expected = pytest.approx(np.concatenate([pose, twist]))
        assert base_from_bytes(serialize_message(message)) == expected
        assert not message.pose.covariance.any() and not message.twist.covariance.any()
        again = deserialize_message(serialize_message(message), Odometry)
        assert again == message


def test_decoder_reads_what_the_message_class_says() -> None:
    """Also where names, sizes or the epoch change from one message to the next."""
    rng = np.random.default_rng(11)
    decoder = JointStateDecoder(read_joint_state)
    for k in range(40):
        names = [f"joint_{i}" for i in range(3 + k // 10)]
        numbers = [rng.normal(size=len(names) if k % 3 else 0), rng.normal(size=2)]
        message = _message(k * 7_000_001, str(k // 4), names, [*numbers, np.ones(len(names))])
        values = decoder.decode(bytes(serialize_message(message)))
        assert (values.stamp_ns, values.frame_id) == (k * 7_000_001, str(k // 4))
        assert list(values.name) == names
        np.testing.assert_array_equal(values.position, numbers[0])
        np.testing.assert_array_equal(values.velocity, numbers[1])
        np.testing.assert_array_equal(values.effort, np.ones(len(names)))


def test_names_are_the_same_object_until_they_change() -> None:
    decoder = JointStateDecoder(read_joint_state)
    encoder = JointStateEncoder(["a", "b"], "0", motion=False)
    first, second = (decoder.decode(encoder.encode(t, np.full(2, t))) for t in (1, 2))
    assert first.name is second.name
    other = decoder.decode(JointStateEncoder(["a", "c"], "0").encode(3, np.zeros(2)))
    assert other.name == ("a", "c")


def _big_endian(strings: int, numbers: np.ndarray) -> bytes:
    body = struct.pack(">iI", 1, 2)
    for _ in range(strings):
        body += bytes(-len(body) % 4) + struct.pack(">I", 5) + b"base\x00"
    body += bytes(-len(body) % 8)
    return b"\x00\x00\x00\x00" + body + numbers.astype(">f8").tobytes()


def test_messages_in_the_other_byte_order_are_read() -> None:
    wrench = np.arange(6.0) - 2.5
    np.testing.assert_array_equal(wrench_from_bytes(_big_endian(1, wrench)), wrench)
    numbers = np.zeros(7 + 36 + 6 + 36)
    numbers[:7] = [1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8]
    numbers[43:49] = np.arange(6.0)
    expected = np.concatenate([numbers[:7], np.arange(6.0)])
    assert base_from_bytes(_big_endian(2, numbers)) == pytest.approx(expected)


@pytest.mark.parametrize("cut", [0, 3, 14, 40])
def test_truncated_odometry_and_wrenches_are_refused(cut: int) -> None:
    odometry = OdometryEncoder("0", "base").encode(0, np.eye(7)[6], np.zeros(6))
    with pytest.raises(InvalidValue, match="no Odometry"):
        base_from_bytes(odometry[:cut])
    with pytest.raises(InvalidValue, match="no WrenchStamped"):
        wrench_from_bytes(WrenchEncoder("world").encode(0, np.zeros(6))[:cut])


JOINTS = ("a", "b", "c")


def _read(**changes: list[float]) -> RobotState:
    """A state of three joints in another order, with some fields replaced."""
    fields = {"position": [0.1, 0.2, 0.3], "velocity": [0.0] * 3, "effort": [1.0, 2.0, 3.0]}
    arrays = (np.array(v) for v in (fields | changes).values())
    values = JointStateValues(5_000_000, "", ("c", "a", "b"), *arrays)
    return JointStateReader(JOINTS).read(values, 0, {})


def test_an_effort_that_is_not_measured_is_nan_and_nothing_else_may_be() -> None:
    """As joint_state_broadcaster says it of a joint without an effort interface."""
    np.testing.assert_array_equal(_read(effort=[np.nan, 2.0, 3.0]).torque, [2.0, 3.0, np.nan])
    assert _read(effort=[np.nan] * 3).torque is None
    assert _read(effort=[]).torque is None
    with pytest.raises(InvalidValue, match="effort: infinite at joint 'b'"):
        _read(effort=[np.nan, 0.0, np.inf])
    for field in ("position", "velocity"):
        with pytest.raises(InvalidValue, match=f"{field}: not a finite number at joint 'a'"):
            _read(**{field: [0.0, np.nan, 0.0]})
    with pytest.raises(InvalidValue, match="effort: 2 entries given, 3 expected"):
        _read(effort=[np.nan, np.nan])


def test_a_joint_that_is_named_twice_has_no_position() -> None:
    """Two drivers merged into one message: which of both is measured is not known."""
    numbers = np.array([0.1, 0.2, 0.3, 2.0])
    twice = JointStateValues(5_000_000, "", ("c", "a", "b", "a"), numbers, numbers, np.zeros(0))
    with pytest.raises(InvalidValue, match=r"joint_states\.name: 'a' is named twice"):
        JointStateReader(JOINTS).read(twice, 0, {})
    other = twice._replace(name=("c", "a", "b", "gripper"))
    assert JointStateReader(JOINTS).read(other, 0, {}).q.tolist() == [0.2, 0.3, 0.1]
    grippers = ("a", "b", "c", "gripper", "gripper")
    more = JointStateValues(0, "", grippers, np.zeros(5), np.zeros(5), np.zeros(0))
    assert JointStateReader(JOINTS).read(more, 0, {}).q.tolist() == [0.0] * 3
