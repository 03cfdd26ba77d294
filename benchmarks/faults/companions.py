"""Messages that every state waits for, forged: wrenches and odometry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.publisher import Publisher

from benchmarks.faults.message_rows import COUNT, PAUSE
from benchmarks.faults.session import Session
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_controller.types import NANOSECONDS


def stamp_ahead(newest: Time, ahead: float) -> Time:
    """Time `ahead` [s] of a stamp."""
    return time_from_nanoseconds(nanoseconds_from_time(newest) + round(ahead * NANOSECONDS))


def send(session: Session, publisher: Publisher, count: int, make: Callable[[], Any]) -> None:
    """Send so many, made anew each time; one alone without a pause after it."""
    for _ in range(count):
        publisher.publish(make())
        session.spin(PAUSE if count > 1 else 0.0)


def send_raw(session: Session, publisher: Publisher) -> None:
    """Send bytes that are no message."""
    send(session, publisher, COUNT, lambda: b"\x00\x01\x00\x00")
