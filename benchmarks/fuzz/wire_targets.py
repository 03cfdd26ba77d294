"""Bytes and states from the wire: codecs, stamps, epochs, plausibility."""

from __future__ import annotations

import struct
from functools import cache
from random import Random
from typing import Any

import numpy as np
from geometry_msgs.msg import WrenchStamped
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from benchmarks.fuzz.target import ODD_FLOAT, Target, mutated
from ghc_controller import GhcError, RobotState, load_robot
from ghc_controller.errors import InvalidValue
from ghc_controller.ros.conversions.states import (
    base_from_bytes,
    read_joint_state,
    wrench_from_bytes,
)
from ghc_controller.ros.wire.cdr import decode_tick, encode_tick
from ghc_controller.ros.wire.joint_state import JointStateDecoder
from ghc_controller.ros.wire.joint_state_reader import JointStateReader
from ghc_controller.ros.wire.synchronizer import StateGate
from ghc_controller.safety.plausibility import StatePlausibility
from ghc_controller.safety.rate_anchor import RateAnchor

JOINTS = tuple(f"joint_{i}" for i in range(1, 8))


def joint_states() -> tuple[bytes, ...]:
    """Sound messages: all fields, none, other orders, more joints."""
    numbers = [0.1 * i for i in range(7)]
    full = JointState(name=JOINTS, position=numbers, velocity=numbers, effort=numbers)
    command = JointState(name=JOINTS[::-1], effort=numbers)
    command.header.frame_id = "controller.1234abcd"
    more = JointState(name=(*JOINTS, "gripper"), position=[0.0] * 8, velocity=[0.0] * 8)
    return tuple(bytes(serialize_message(m)) for m in (full, command, more, JointState()))


DECODER = JointStateDecoder(read_joint_state)  # kept: its layout is what a bad message may spoil
READER = JointStateReader(JOINTS)


def read_state(data: bytes) -> None:
    """As the controller reads a state."""
    state = READER.read(DECODER.decode(data), 0, {})
    assert np.isfinite(state.q).all()
    assert np.isfinite(state.v).all()


def read_base(data: bytes) -> None:
    """As the controller reads odometry."""
    base = base_from_bytes(data)
    assert base.shape == (13,)
    assert np.isfinite(base).all()


def read_wrench(data: bytes) -> None:
    """As the controller reads a wrench."""
    assert np.isfinite(wrench_from_bytes(data)).all()


def judge_stamps(case: list[tuple[int, int, int]]) -> None:
    """A gate takes any stamps, numbers of runs and starts."""
    gate: StateGate[int] = StateGate(("left",), ("plan",), 10_000_000)
    for k, (stamp, epoch, start) in enumerate(case):
        gate.timeline.announce(epoch, start)
        gate.state(k, stamp)
        gate.companion("left", stamp, np.zeros(6))
        gate.plan("plan", stamp, epoch)
        gate.missing(stamp)
        gate.timeline.expected()


@cache
def kuka() -> Any:
    """The robot whose limits count."""
    return load_robot("kuka_lwr").model.limits


def judge_states(case: list[tuple[float, list[float], list[float], list[float]]]) -> None:
    """Whatever is measured, only InvalidValue comes out; anchors of the rate limit are finite."""
    limits = kuka()
    checks = StatePlausibility(JOINTS, limits)
    for time, q, v, effort in case:
        state = RobotState(time, np.array(q), np.array(v), np.array(effort), {}, 0)
        anchor = RateAnchor(limits.torque, np.full(7, 1.0), 1e-3)
        assert np.isfinite(anchor.before(state, lambda: np.zeros(7))).all()
        try:
            checks.check(state)
        except InvalidValue:
            continue


def _edit_stamps(case: list[tuple[int, int, int]], random: Random) -> list[tuple[int, int, int]]:
    """One stamp, number or start another one; those of the wire have 64 bits."""
    if case:
        entry = list(case[at := random.randrange(len(case))])
        entry[random.randrange(3)] = random.getrandbits(random.choice((2, 28, 62)))
        case[at] = (entry[0], entry[1], entry[2])
    return case


def _edit_states(case: list[Any], random: Random) -> list[Any]:
    """One position, velocity or effort another one; the first two are finite, as they are read."""
    if case:
        _, *rows = case[random.randrange(len(case))]
        row = random.choice(rows)
        (odd,) = struct.unpack("<d", random.randbytes(8))
        number = random.choice((random.uniform(-3.0, 3.0), odd))
        if row is rows[2] or np.isfinite(number):
            row[random.randrange(len(row))] = number
    return case


def targets() -> tuple[Target, ...]:
    """All of this file."""
    finite = st.floats(allow_nan=False, allow_infinity=False)
    row = st.lists(st.one_of(st.floats(-3.0, 3.0), finite), min_size=7, max_size=7)
    effort = st.lists(ODD_FLOAT, min_size=7, max_size=7)
    stamp = st.one_of(st.integers(0, 2 * 10**8), st.integers(-(2**62), 2**62))
    epoch = st.one_of(st.integers(0, 3), st.integers(0, 2**64 - 1))
    odometry = Odometry()
    odometry.header.frame_id, odometry.child_frame_id = "world", "base"
    odometry.pose.pose.orientation.w = 1.0
    wrench = bytes(serialize_message(WrenchStamped()))
    reject = (GhcError, ValueError)
    return (
        Target("joint_state", mutated(joint_states()), read_state, reject),
        Target("joint_state_noise", st.binary(max_size=400), read_state, reject),
        Target("odometry", mutated((bytes(serialize_message(odometry)),)), read_base),
        Target("wrench", mutated((wrench,)), read_wrench),
        Target(
            "tick",
            mutated((encode_tick(10_000_000, 1),)),
            lambda d: decode_tick(d) and None,
            (ValueError,),
        ),
        Target(
            "stamps",
            st.lists(st.tuples(stamp, epoch, stamp), max_size=12),
            judge_stamps,
            edit=_edit_stamps,
        ),
        Target(
            "states",
            st.lists(st.tuples(st.floats(0.0, 1e9), row, row, effort), max_size=5),
            judge_states,
            edit=_edit_states,
        ),
    )
