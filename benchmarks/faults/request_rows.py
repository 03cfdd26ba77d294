"""Floods, malformed and absurd requests; services; the clock."""

from __future__ import annotations

import time
from functools import partial
from typing import Any

import numpy as np
from ghc_msgs.msg import PriorityTransition, TaskReference, TaskReferencePoint
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Header
from std_srvs.srv import Trigger

from benchmarks.faults.row import Inject, Limits, Row
from benchmarks.faults.session import Session
from ghc_controller.ros.qos import CLOCK_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds

FLOOD = 1.5  # [s] wall at 1 kHz
ORDERS = ("elbow > end_effector > posture", "end_effector > elbow > posture", "posture")
MALFORMED: tuple[dict[str, Any], ...] = (
    {},
    {"hierarchy": "elbow >> posture"},
    {"hierarchy": "wrist"},
    {"hierarchy": "elbow > elbow"},
    {"hierarchy": ">"},
    {"hierarchy": "="},
    {"hierarchy": "\u0000"},
    {"hierarchy": "elbow", "duration": -1.0},
    {"hierarchy": "elbow", "duration": float("nan")},
    {"hierarchy": "elbow", "duration": float("inf")},
    {"hierarchy": "elbow", "torque_rate": -1.0},
    {"hierarchy": "elbow", "torque_rate": float("nan")},
    {"hierarchy": "elbow", "profile": "square"},
    {"hierarchy": "elbow", "tasks": ["elbow"], "alpha": [0.0]},
    {"tasks": ["elbow"], "alpha": []},
    {"tasks": ["elbow", "elbow"], "alpha": [0.0] * 4},
    {"tasks": ["elbow"], "alpha": [float("nan")]},
    {"tasks": ["elbow", "posture"], "alpha": [0.0, 2.0, 0.0, 0.0]},
    {"tasks": ["end_effector", "elbow", "posture"], "alpha": [1.0] * 9},
    {"tasks": ["wrist"], "alpha": [0.0]},
)


def now_of(session: Session) -> float:
    """The robot's time [s]."""
    assert session.state is not None
    return nanoseconds_from_time(session.state.header.stamp) * 1e-9


def flood(messages: tuple[Any, ...]) -> Inject:
    """The messages in turn, at 1 kHz."""

    def inject(session: Session, _: np.random.Generator) -> None:
        end, k = time.monotonic() + FLOOD, 0
        while time.monotonic() < end:
            message = messages[k % len(messages)]
            is_reference = isinstance(message, TaskReference)
            (session.references if is_reference else session.transitions).publish(message)
            session.spin(1e-3)
            k += 1

    return inject


def publish_once(message: Any) -> Inject:
    """One request."""

    def inject(session: Session, _: np.random.Generator) -> None:
        is_reference = isinstance(message, TaskReference)
        (session.references if is_reference else session.transitions).publish(message)

    return inject


def scheduled(kind: str, session: Session, rng: np.random.Generator) -> None:
    """3000 requests for one instant, or in sequence."""
    start = now_of(session) + 0.5
    for k in range(3000):
        if kind == "transitions":
            header = Header(stamp=time_from_seconds(start))
            order = ORDERS[int(rng.integers(2))]
            session.transitions.publish(
                PriorityTransition(header=header, hierarchy=order, duration=0.1 + 1e-4 * k)
            )
        else:
            header = Header(stamp=time_from_seconds(start + 1e-3 * k))
            session.references.publish(
                TaskReference(header=header, task="end_effector", points=[_point([0.5, 0, 0.6])])
            )
        if k % 50 == 0:
            session.spin(0.005)


def late(session: Session, _: np.random.Generator) -> None:
    """A transition whose start was 1.5 s ago, while another ramp runs."""
    session.ask(ORDERS[0], 2.0)
    header = Header(stamp=time_from_seconds(now_of(session) - 1.5))
    session.ask(ORDERS[2], 2.0, header=header)


def resets(count: int, session: Session, _: np.random.Generator) -> None:
    """The bridge's reset during a transition."""
    session.ask(ORDERS[0], 1.0)
    client = session.node.create_client(Trigger, "sim_bridge/reset")
    session.until(client.service_is_ready, "the service")
    for _k in range(count):
        client.call_async(Trigger.Request())
        session.spin(0.01)
    session.spin(0.5)
    session.node.destroy_client(client)


def clock(session: Session, rng: np.random.Generator) -> None:
    """/clock backwards and forwards."""
    publisher = session.node.create_publisher(Clock, "/clock", CLOCK_QOS)
    for _k in range(50):
        publisher.publish(Clock(clock=time_from_seconds(float(rng.uniform(0.0, 1e6)))))
        session.spin(0.02)
    session.node.destroy_publisher(publisher)


def _point(position: list[float], **fields: list[float]) -> TaskReferencePoint:
    return TaskReferencePoint(position=[float(x) for x in position], **fields)


def _reference(position: list[float], task: str = "end_effector", **fields: Any) -> TaskReference:
    return TaskReference(task=task, points=[_point(position, **fields)])


def _many_points(count: int) -> TaskReference:
    points = []
    for k in range(count):
        point = _point([0.5, 0.0, 0.6])
        point.time_from_start.sec, point.time_from_start.nanosec = divmod(k * 1_000_000, 10**9)
        points.append(point)
    return TaskReference(task="end_effector", points=points)


def many_points(count: int, session: Session, rng: np.random.Generator) -> None:
    """A reference with many points, created here because of its size."""
    publish_once(_many_points(count))(session, rng)


def _transition(hierarchy: str, duration: float = 0.5) -> PriorityTransition:
    return PriorityTransition(hierarchy=hierarchy, duration=duration)


_NAMES = {n: " > ".join(f"t{k}" for k in range(n)) for n in (5_000, 20_000)}
_FLOODS: dict[str, tuple[Any, ...]] = {
    "transitions, valid, alternating": tuple(_transition(order) for order in ORDERS),
    "transitions, invalid": (_transition("wrist"),),
    "transitions, duration 0": tuple(_transition(order, 0.0) for order in ORDERS),
    "malformed transitions (20 kinds)": tuple(PriorityTransition(**m) for m in MALFORMED),
    "references": (_reference([0.45, 0.2, 0.6]), _reference([0.45, -0.2, 0.6])),
    "references 20 m apart": (_reference([20.0, 0, 0]), _reference([-20.0, 0, 0])),
    "references NaN, Inf": (_reference([float("nan")] * 3), _reference([float("inf")] * 3)),
}
_REFERENCES: dict[str, TaskReference] = {
    "1e6 m": _reference([1e6, 0, 0]),
    "1e300 m": _reference([1e300, 0, 0]),
    "velocity 1e5 m/s, acceleration 1e9 m/s^2": _reference(
        [0.5, 0, 0.6], velocity=[1e5, 0.0, 0.0], acceleration=[1e9, 0.0, 0.0]
    ),
    "posture 10 rad": _reference([10.0] * 7, "posture"),
}
_HIERARCHIES = {
    "'a>' 50 000 times": "a>" * 50_000,
    "'a>' 5000 times": "a>" * 5_000,
    "1e6 times 'x'": "x" * 1_000_000,
    "of 5e3 names": _NAMES[5_000],
    "of 2e4 names": _NAMES[20_000],
    "in other alphabets": "\u03b1 > \u05d0 > \U0001f916",
}
_SLOW = Limits(recovery=4.0)

ROWS = (
    *(
        Row(f"flood 1 kHz: {name}", flood(messages), "requests", quick="valid" in name)
        for name, messages in _FLOODS.items()
    ),
    *(
        Row(
            f"ONE hierarchy {name}",
            publish_once(_transition(text)),
            "requests",
            quick="x" in name,
        )
        for name, text in _HIERARCHIES.items()
    ),
    *(
        Row(f"task_reference {name}", publish_once(message), "requests", quick=name == "1e6 m")
        for name, message in _REFERENCES.items()
    ),
    *(
        Row(
            f"ONE task_reference of {count:g} points",
            partial(many_points, count),
            "requests",
            quick=count == 100_000,
            limits=_SLOW,
        )
        for count in (1_000, 10_000, 100_000)
    ),
    Row(
        "3000 transitions for one instant",
        partial(scheduled, "transitions"),
        "requests",
        after=3.0,
        limits=_SLOW,
    ),
    Row(
        "3000 references ahead",
        partial(scheduled, "references"),
        "requests",
        after=3.0,
        limits=_SLOW,
    ),
    Row("target 3 m away for 5 s", publish_once(_reference([3.0, 0, 0.5])), "requests", after=5.0),
    Row("transition 1.5 s late", late, "requests", after=2.0, quick=True),
    Row("reset during a transition", partial(resets, 1), "services"),
    Row("100 resets in a second", partial(resets, 100), "services"),
    Row("/clock backwards and forwards", clock, "services"),
)
