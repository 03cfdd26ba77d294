"""One forged tick or obstacle array does not blind a generator."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from ghc_msgs.msg import ConstraintPreviews, Epoch, ObstacleState, ObstacleStateArray, Tick
from rclpy.node import Node
from std_msgs.msg import Header

from benchmarks.faults.session import PATIENCE, Session
from ghc_controller.ros.qos import PREVIEW_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds

FUTURE = [Time(sec=10**6), Time(sec=2**31 - 1, nanosec=999_999_999), Time(sec=-(2**31))]


class World:
    """Ticks and one obstacle as controller and sensor send them; the plans that come."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.plans: list[ConstraintPreviews] = []
        self.node: Node = session.node
        self.node.create_subscription(
            ConstraintPreviews, "constraints/preview", self.plans.append, PREVIEW_QOS
        )
        self.now = 1.0  # [s]

    def until(self, condition: Callable[[], Any]) -> None:
        """Go on in real time until something is so."""
        self.plans.clear()
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, self.session.output("obstacle_bounds")
            self.now = round(self.now + 0.01, 9)
            self.session.obstacles.publish(self.array(time_from_seconds(self.now)))
            self.session.ticks.publish(Tick(start=time_from_seconds(self.now)))
            self.session.spin(0.01)

    @property
    def planned(self) -> list[str]:
        """Obstacles in the newest plan."""
        return [entry.id for plan in self.plans[-1:] for entry in plan.previews[0].motions]

    def goes_on(self) -> bool:
        """Plans come for the present time, with the obstacle in them."""
        return (
            len(self.plans) > 20
            and _newest(self.plans) > self.now - 0.5
            and self.planned == ["ball_0"]
        )

    def array(self, stamp: Time, obstacles: int = 1) -> ObstacleStateArray:
        """What a sensor sends."""
        message = ObstacleStateArray(header=Header(stamp=stamp))
        for k in range(obstacles):
            message.obstacles.append(
                ObstacleState(
                    id=f"ball_{k}",
                    protected_frame="tool",
                    position=[0.5, 0.0, 0.5],
                    normal=[1.0, 0.0, 0.0],
                    distance=0.3,
                    safe_distance=0.2,
                )
            )
        return message


@pytest.fixture
def world(tmp_path: Path) -> Any:
    """A generator of obstacle motion that plans."""
    with Session(tmp_path) as session:
        session.start("obstacle_bounds", take_over_timeout=0.0)
        world = World(session)
        world.until(lambda: world.planned)
        yield world


def _newest(plans: list[ConstraintPreviews]) -> float:
    return max(nanoseconds_from_time(plan.header.stamp) * 1e-9 for plan in plans)


@pytest.mark.parametrize("stamp", FUTURE, ids=lambda s: str(s.sec))
def test_forged_stamps(world: World, stamp: Time) -> None:
    """A tick of another time, one of another epoch, an empty obstacle array of the future."""
    session = world.session
    session.ticks.publish(Tick(start=stamp))
    session.ticks.publish(Tick(start=stamp, epoch=999_999))
    session.epochs.publish(Epoch(start=stamp, number=999_999))
    session.obstacles.publish(world.array(stamp, obstacles=0))
    world.until(world.goes_on)
    assert session.processes["obstacle_bounds"].exit_code is None


def test_bytes_that_are_no_message(world: World) -> None:
    for publisher in (world.session.ticks, world.session.obstacles):
        for _ in range(5):
            publisher.publish(b"\x00\x01\x00\x00")
            world.session.spin(0.02)
    world.until(world.goes_on)
    assert world.session.processes["obstacle_bounds"].exit_code is None
