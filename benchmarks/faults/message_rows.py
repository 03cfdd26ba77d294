"""Forged joint states and joint commands: content, layout, stamps, bytes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from ghc_msgs.msg import Epoch
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from benchmarks.faults.row import Inject, Row
from benchmarks.faults.session import JOINTS, Session

NAN, INF = float("nan"), float("inf")
PAUSE = 0.015  # [s] wall between two forged messages
COUNT = 60  # [-] forged messages of a row
FOREVER = 2**31 - 1  # [s]
HALF = 4  # [-] names of a message of the wrong size


def states(count: int, session: Session, _: np.random.Generator, **changes: Any) -> None:
    """Forged states a period ahead of the true one."""
    for _k in range(count):
        session.forge_state(**{"ahead": session.control_dt, **changes})
        session.spin(PAUSE)


def one(session: Session, _: np.random.Generator, **changes: Any) -> None:
    """A single forged state."""
    session.forge_state(**changes)


def epochs(start: Time | None, session: Session, _: np.random.Generator) -> None:
    """Runs announced that do not begin; without `start` at the newest stamp."""
    for k in range(COUNT):
        assert session.state is not None
        session.epochs.publish(Epoch(start=start or session.state.header.stamp, number=k + 7))
        session.spin(PAUSE)


def shifted(session: Session, rng: np.random.Generator) -> None:
    """Positions 1 rad off, for all joints or none: a plausible range, an impossible jump."""
    for _k in range(COUNT):
        assert session.state is not None
        joint = int(rng.integers(len(JOINTS)))
        session.forge_state(session.control_dt, position=session.state.position[joint] + 1.0)
        session.spin(PAUSE)


def commands(
    make: Callable[[Session, int], JointState], session: Session, _: np.random.Generator
) -> None:
    """Forged commands with the newest stamp."""
    for k in range(COUNT):
        session.commands_out.publish(make(session, k))
        session.spin(PAUSE)


def one_command(session: Session, _: np.random.Generator, **changes: Any) -> None:
    """A single forged command."""
    session.commands_out.publish(_command(session, 0, **changes))


def _command(session: Session, k: int, **changes: Any) -> JointState:
    assert session.state is not None
    message = JointState(name=JOINTS[::-1], effort=[0.0] * len(JOINTS))
    message.header.stamp = session.state.header.stamp
    for name, value in changes.items():
        given = value[k % len(value)] if isinstance(value, tuple) else value
        if name == "effort" and isinstance(given, float):
            given = [given] * len(JOINTS)
        if name in ("stamp", "frame_id"):
            setattr(message.header, name, given)
        else:
            setattr(message, name, given)
    return message


def bytes_on(topic: str, data: Callable[[Session], bytes]) -> Inject:
    """Raw bytes on a topic."""

    def inject(session: Session, _: np.random.Generator) -> None:
        publisher = {"joint_states": session.states_out, "joint_commands": session.commands_out}
        for _k in range(COUNT):
            publisher[topic].publish(data(session))
            session.spin(PAUSE)

    return inject


def _big_endian(session: Session) -> bytes:
    """A valid state in another machine's encoding, repeated; only its header differs."""
    data = bytearray(serialize_message(session.state))
    data[1] = 0
    return bytes(data)


_STATES: dict[str, dict[str, Any]] = {
    "q NaN": {"position": NAN},
    "q Inf": {"position": INF},
    "q 1e300": {"position": 1e300},
    "v NaN": {"velocity": NAN},
    "v 1e300": {"velocity": 1e300},
    "v 1e3": {"velocity": 1e3},
    "effort NaN": {"effort": NAN},
    "effort 1e300": {"effort": 1e300},
    "effort -1e4": {"effort": -1e4},
    "effort empty (sound)": {"effort": []},
    "sizes wrong": {"name": list(JOINTS[:HALF])},
    "all arrays empty": {"name": [], "position": [], "velocity": [], "effort": []},
    "unknown names only": {"name": [f"unknown_{k}" for k in range(len(JOINTS))]},
    "duplicated names": {"name": ["joint_1"] * len(JOINTS)},
    "8 names, joint_1 twice": {
        "name": [*JOINTS, "joint_1"],
        **{field: [0.3] * 8 for field in ("position", "velocity", "effort")},
    },
    "stale -0.5 s": {"ahead": -0.5},
    "repeated": {"ahead": 0.0},
    "reordered": {"ahead": -0.01},
    "permuted names (sound)": {"ahead": 0.0},
    "1e5 names": {"name": ["x"] * 100_000},
    "stamp +1 h, 60 times": {"ahead": 3600.0},
}
_ONE: dict[str, dict[str, Any]] = {
    "stamp +1 h": {"ahead": 3600.0},
    "stamp +0.09 s": {"ahead": 0.09},
    "stamp 2^31-1 s, 4e9 ns": {"stamp": Time(sec=FOREVER, nanosec=4_000_000_000)},
    "stamp 2^31-1 s": {"stamp": Time(sec=FOREVER, nanosec=999_999_999)},
    "stamp -2^31 s": {"stamp": Time(sec=-FOREVER - 1)},
    "effort -1e4": {"effort": -1e4},
}
_COMMANDS: dict[str, dict[str, Any]] = {
    "effort NaN": {"effort": NAN},
    "effort Inf": {"effort": INF},
    "effort 1e300": {"effort": 1e300},
    "effort +-1e4": {"effort": (1e4, -1e4)},
    "zeros": {"effort": 0.0},
    "sizes wrong": {"effort": [0.0] * HALF},
    "empty": {"name": [], "effort": []},
    "duplicated": {"name": ["joint_1"] * len(JOINTS)},
    "unknown": {"name": [f"unknown_{k}" for k in range(len(JOINTS))]},
    "other sender": {"frame_id": "intruder", "effort": 30.0},
    "stamp of the future": {"stamp": Time(sec=FOREVER)},
    "stamp of the past": {"stamp": Time(sec=0)},
}
_EPOCHS: dict[str, Time | None] = {
    "of now": None,
    "of the start, again": Time(),
    "of 1e6 s": Time(sec=10**6),
    "of 2^31-1 s": Time(sec=FOREVER, nanosec=999_999_999),
}
_QUICK = {"q NaN", "v 1e3", "effort -1e4", "stamp +1 h", "zeros", "effort 1e300"}

ROWS = (
    *(
        Row(
            f"joint_states {name}",
            partial(states, COUNT, **changes),
            "joint_states",
            latches=name in ("v 1e3", "q 1e300", "v 1e300"),
            quick=name in _QUICK,
        )
        for name, changes in _STATES.items()
    ),
    Row("joint_states q +1 rad", shifted, "joint_states", latches=True, quick=True),
    *(
        Row(
            f"ONE joint_states {name}",
            partial(one, **changes),
            "joint_states",
            quick=name in _QUICK,
        )
        for name, changes in _ONE.items()
    ),
    *(
        Row(
            f"sim_bridge/epoch {name}", partial(epochs, start), "joint_states", quick=start is None
        )
        for name, start in _EPOCHS.items()
    ),
    Row("5 joint_states effort -1e4", partial(states, 5, effort=-1e4), "joint_states"),
    *(
        Row(
            f"joint_commands {name}",
            partial(commands, partial(_command, **changes)),
            "joint_commands",
            quick=name in _QUICK,
        )
        for name, changes in _COMMANDS.items()
    ),
    Row(
        "ONE joint_commands stamp 2^31-1 s",
        partial(one_command, stamp=Time(sec=FOREVER)),
        "joint_commands",
    ),
    Row(
        "raw bytes on joint_states",
        bytes_on("joint_states", lambda _: b"\x00\x01\x00\x00"),
        "bytes",
    ),
    Row("raw bytes on joint_commands", bytes_on("joint_commands", lambda _: bytes(33)), "bytes"),
    Row("other byte order on joint_states", bytes_on("joint_states", _big_endian), "bytes"),
)
