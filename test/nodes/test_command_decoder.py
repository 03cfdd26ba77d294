"""Commands from the wire: any order of joints, and nothing that is not a torque for each."""

from __future__ import annotations

import numpy as np
import pytest
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from ghc_controller.ros.conversions.states import read_joint_state
from ghc_controller.ros.time import time_from_nanoseconds
from ghc_sim_bridge.bridge.commands import CommandDecoder, CommandRejected

NAMES = [f"joint_{k}" for k in range(1, 8)]


def _decoder() -> CommandDecoder:
    return CommandDecoder(NAMES, read_joint_state)


def _command(
    effort: list[float], names: list[str] = NAMES, stamp_ns: int = 0, sender: str = ""
) -> bytes:
    message = JointState(name=names, effort=effort)
    message.header.stamp = time_from_nanoseconds(stamp_ns)
    message.header.frame_id = sender
    return bytes(serialize_message(message))


def test_effort_comes_back_in_the_order_of_the_bridge() -> None:
    rng = np.random.default_rng(3)
    decoder = _decoder()
    for _ in range(20):
        order = rng.permutation(7)
        torque = rng.normal(size=7)
        stamp = int(rng.integers(0, 10**12))
        data = _command(torque[order].tolist(), [NAMES[k] for k in order], stamp)
        for _ in range(2):  # read in full, then by what is known of it
            command = decoder.decode(data)
            np.testing.assert_array_equal(command.torque, torque)
            assert command.stamp_ns == stamp


@pytest.mark.parametrize(
    ("names", "effort", "field", "words"),
    [
        (NAMES[:6], [0.0] * 6, "name", "'joint_7' is missing"),
        ([*NAMES, "gripper"], [0.0] * 8, "name", "unknown joint 'gripper'; known: joint_1"),
        ([*NAMES, "joint_1"], [0.0] * 8, "name", "named twice"),
        ([], [], "name", "'joint_1' is missing"),
        (NAMES, [0.0] * 6, "effort", "size 6 given, 7 expected"),
        (NAMES, [], "effort", "size 0 given, 7 expected"),
        (NAMES, [0.0, 0.0, float("nan"), 0.0, 0.0, 0.0, 0.0], "effort", "joint_3 is nan"),
        (NAMES, [0.0] * 6 + [float("-inf")], "effort", "joint_7 is -inf"),
    ],
)
def test_rejection_names_the_field(
    names: list[str], effort: list[float], field: str, words: str
) -> None:
    """Also right after good commands, when names and sizes are already known."""
    decoder = _decoder()
    good = _command([1.0] * 7)
    for _ in range(2):
        with pytest.raises(CommandRejected, match=words) as caught:
            decoder.decode(_command(effort, names))
        assert caught.value.field == field
        np.testing.assert_array_equal(decoder.decode(good).torque, np.ones(7))


def test_the_frame_id_names_the_sender() -> None:
    decoder = _decoder()
    for name in ("", "controller_1f", "other"):
        assert decoder.decode(_command([1.0] * 7, sender=name)).sender == name


@pytest.mark.parametrize("cut", [0, 3, 11, 40, 150])
def test_truncated_bytes_are_rejected(cut: int) -> None:
    decoder = _decoder()
    whole = _command([1.0] * 7)
    decoder.decode(whole)
    with pytest.raises(CommandRejected):
        decoder.decode(whole[:cut])


def test_positions_beside_the_efforts_do_not_disturb() -> None:
    decoder = _decoder()
    message = JointState(name=NAMES, position=[9.0] * 7, velocity=[8.0] * 7, effort=[1.0] * 7)
    data = bytes(serialize_message(message))
    for _ in range(2):
        np.testing.assert_array_equal(decoder.decode(data).torque, np.ones(7))
