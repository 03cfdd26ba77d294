"""Faults of the constraint generators, their inputs and their outputs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from ghc_msgs.msg import (
    ConstraintPreview,
    ConstraintPreviews,
    ContactSchedule,
    ObstacleState,
    ObstacleStateArray,
    PlannedMotion,
    Tick,
)
from std_msgs.msg import Header

from benchmarks.faults.process_rows import freeze, kill_and_restart
from benchmarks.faults.request_rows import now_of
from benchmarks.faults.row import Bench, Limits, Row, nothing
from benchmarks.faults.session import Session
from ghc_controller.ros.qos import PREVIEW_QOS, SCHEDULE_QOS
from ghc_controller.ros.time import time_from_seconds

FOREVER = 2**31 - 1  # [s]
GENERATORS = ("contact_force_bounds", "obstacle_bounds")
STOPS = (0.005, 0.05, 0.5, 5.0)  # [s]
COUNT, PAUSE = 100, 0.01  # [-] messages, [s] wall between them
NEAR = Limits(speed=4.0, recovery=4.0)  # a forged obstacle pushes the arm


def measured(session: Session, count: int, **fields: Any) -> ObstacleStateArray:
    """Message of an obstacle sensor."""
    message = ObstacleStateArray(header=Header(stamp=time_from_seconds(now_of(session))))
    for k in range(count):
        entry = ObstacleState(
            id=f"ball_{k}",
            protected_frame="tool",
            position=[0.9, 0.0, 0.6],
            normal=[-1.0, 0.0, 0.0],
            distance=0.4,
            safe_distance=0.1,
        )
        for name, value in fields.items():
            setattr(entry, name, value)
        message.obstacles.append(entry)
    return message


def planned(session: Session, **fields: Any) -> ConstraintPreviews:
    """Message of a second generator of obstacle motion."""
    entry = PlannedMotion(
        id="ball_0",
        protected_frame="tool",
        position=[0.9, 0.0, 0.6],
        normal=[-1.0, 0.0, 0.0],
        safe_distance=0.1,
        jerk=[0.0] * 3,
    )
    for name, value in fields.items():
        setattr(entry, name, value)
    return _previews(session, ConstraintPreview(kind="obstacle_motion", motions=[entry]))


def two_walls(session: Session) -> ConstraintPreviews:
    """Two obstacles that face each other, with the tool between them."""
    message = planned(session)
    (preview,) = message.previews
    for sign in (-1.0, 1.0):
        wall = planned(session, id=f"wall_{sign:+g}", position=[0.45, 0.15 * sign, 0.6])
        wall.previews[0].motions[0].normal[:] = [0.0, -sign, 0.0]
        preview.motions.append(wall.previews[0].motions[0])
    del preview.motions[0]
    return message


def bounds(session: Session, lower: float, upper: float, on: bool) -> ConstraintPreviews:
    """Message of a second generator of force bounds, for the tool."""
    message = ConstraintPreview(kind="contact_forces", interpolate=True, rows=["tool"])
    message.lower, message.upper = [lower] * 151, [upper] * 151
    message.active, message.conflict, message.status = [on], [False], [1]
    return _previews(session, message)


def _previews(session: Session, preview: ConstraintPreview) -> ConstraintPreviews:
    """A message of a generator with the name of the running one."""
    names = {"contact_forces": "contact_force_bounds", "obstacle_motion": "obstacle_bounds"}
    preview.name, preview.step, preview.points = names[preview.kind], 0.01, 151
    message = ConstraintPreviews(previews=[preview])
    message.header.stamp = time_from_seconds(now_of(session))
    return message


def sensor(make: Callable[[Session], ObstacleStateArray], count: int = COUNT) -> Any:
    """Publish on constraints/obstacles."""

    def inject(session: Session, _: np.random.Generator) -> None:
        for _k in range(count):
            session.obstacles.publish(make(session))
            session.spin(PAUSE)

    return inject


def plans(make: Callable[[Session], Any]) -> Any:
    """Publish as a second generator."""

    def inject(session: Session, _: np.random.Generator) -> None:
        publisher = session.node.create_publisher(
            ConstraintPreviews, "constraints/preview", PREVIEW_QOS
        )
        for _k in range(COUNT):
            publisher.publish(make(session))
            session.spin(PAUSE)
        session.node.destroy_publisher(publisher)

    return inject


def schedules(make: Callable[[int], ContactSchedule], session: Session, _: Any) -> None:
    """Publish schedules of contacts."""
    publisher = session.node.create_publisher(
        ContactSchedule, "constraints/contact_schedule", SCHEDULE_QOS
    )
    for k in range(500):
        publisher.publish(make(k))
        session.spin(0.002)
    session.node.destroy_publisher(publisher)


def tick(start: Time, epoch: int, session: Session, _: np.random.Generator) -> None:
    """One forged tick."""
    session.ticks.publish(Tick(start=start, epoch=epoch))


def _schedule(k: int, **fields: Any) -> ContactSchedule:
    values = {"contact": "tool", "times": [0.0], "lower": [0.0], "upper": [0.0]} | fields
    return ContactSchedule(**{n: v(k) if callable(v) else v for n, v in values.items()})


def _stamped(message: ObstacleStateArray, seconds: int) -> ObstacleStateArray:
    message.header.stamp = Time(sec=seconds)
    return message


_NAN = float("nan")

_ROWS: dict[str, Any] = {
    "baseline with generators": nothing,
    **{f"{name} kill -9": partial(kill_and_restart, name) for name in GENERATORS},
    **{
        f"{name} SIGSTOP {1e3 * seconds:g} ms": partial(freeze, name, seconds)
        for name in GENERATORS
        for seconds in STOPS
    },
    "controller kill -9 with generators": partial(kill_and_restart, "controller"),
    "ONE obstacles, empty, stamp 2^31-1 s": sensor(lambda s: _stamped(measured(s, 0), FOREVER), 1),
    "ghc/tick stamp 1e6 s": partial(tick, Time(sec=10**6), 0),
    "ghc/tick stamp 2^31-1 s": partial(tick, Time(sec=FOREVER, nanosec=999_999_999), 0),
    "ghc/tick epoch 999999": partial(tick, Time(), 999_999),
    "100 obstacles": sensor(lambda s: measured(s, 100), 10),
    "1e4 obstacles": sensor(lambda s: measured(s, 10_000), 1),
    "obstacle flickers": sensor(lambda s: measured(s, int(10.0 * now_of(s)) % 2)),
    "malformed obstacles": sensor(lambda s: measured(s, 1, normal=[_NAN] * 3, distance=_NAN)),
    "contact_schedule flood": partial(schedules, _schedule),
    "500 contact names in schedules": partial(
        schedules, partial(_schedule, contact=lambda k: f"contact_{k}")
    ),
    "malformed schedules": partial(schedules, partial(_schedule, lower=[_NAN])),
    "second force generator: lower 1e6 N": plans(lambda s: bounds(s, 1e6, 2e6, True)),
    "second force generator: lower > upper": plans(lambda s: bounds(s, 50.0, 10.0, False)),
    "second force generator: contact off and on": plans(
        lambda s: bounds(s, 0.0, 100.0, int(10.0 * now_of(s)) % 2 == 0)
    ),
    "second motion generator: v 1e300": plans(lambda s: planned(s, velocity=[1e300] * 3)),
    "second motion generator: obstacle in the arm": plans(
        lambda s: planned(s, position=[0.4, 0.0, 0.5])
    ),
    "second motion generator: two walls, both sides": plans(two_walls),
}

ROWS = tuple(
    Row(
        name,
        inject,
        "generators",
        bench=Bench.CONTACT,
        limits=Limits(recovery=30.0, hold=0.02) if "controller kill" in name else NEAR,
        quick="tick" in name or "obstacles, empty" in name or "1e6 N" in name,
    )
    for name, inject in _ROWS.items()
)
