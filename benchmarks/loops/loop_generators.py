"""Inputs of the closed loop with generators: a contact, an obstacle, a changing schedule."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from ghc_msgs.msg import ContactSchedule as ContactScheduleMessage
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node

import ghc_controller as ghc
from ghc_controller.ros.qos import SCHEDULE_QOS
from ghc_mpc_constraints import ContactSchedule
from ghc_mpc_constraints.ros.conversions import schedule_message
from ghc_sim_bridge.scenario.robot_changes import write_changed_robot

SCENE = Path(__file__).with_name("loop_scene.yaml")
NODES: dict[str, dict[str, Any]] = {  # generator -> its parameters
    "contact_force_bounds": {"generator": "contact_force_bounds"},
    "obstacle_bounds": {"generator": "obstacle_bounds", "sensor_period": 0.1},
}
WAIT_FOR = "[contact_forces, obstacle_motion]"
_DEADLINE = 180.0  # [s] wall
_LOOK_EVERY = Duration(seconds=1)  # wall
_CONTACT = "tool"
_JUMP_EVERY = 0.5  # [s]
_LAST_JUMP = 60.0  # [s]
_UPPER = (60.0, 20.0)  # [N] in turns; never zero: the contact stays on


def write_robot(robot: str, folder: Path) -> Path:
    """The robot with a contact at its tool, which stands still in the air: no harm is done."""
    contact: dict[str, Any] = {
        "name": _CONTACT,
        "frame": "tool",
        "points": [[0.0, 0.0, 0.0]],
        "normal": [0.0, 0.0, 1.0],
        "friction": 0.5,
        "active": True,
    }
    changes = {"contacts": [contact]}
    return write_changed_robot(ghc.load_robot(robot).path, changes, folder / "robot.yaml")


def schedule() -> ContactSchedule:
    """The upper bound jumps twice a second."""
    times = np.arange(0.0, _LAST_JUMP, _JUMP_EVERY).tolist()
    upper = [_UPPER[i % 2] for i in range(len(times))]
    return ContactSchedule.checked(_CONTACT, times, [0.0] * len(times), upper)


@contextmanager
def published_schedule(
    domain: int, folder: Path
) -> Iterator[Callable[[Callable[[], None]], None]]:
    """Keeps the schedule on its topic, for a generator that starts at any time.

    Yields a function that returns when the generator has received it. Time must not run before:
    in lockstep a whole run may be over while the middleware still introduces the two. It calls
    its argument now and then, to look after the nodes, and raises GhcError after a while.
    """
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ["ROS_LOG_DIR"] = str(folder)
    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    try:
        node = Node("planner", context=context)
        publisher = node.create_publisher(
            ContactScheduleMessage, "constraints/contact_schedule", SCHEDULE_QOS
        )
        publisher.publish(schedule_message(schedule()))

        def wait_until_received(check: Callable[[], None]) -> None:
            deadline = time.monotonic() + _DEADLINE
            while not (
                publisher.get_subscription_count() and publisher.wait_for_all_acked(_LOOK_EVERY)
            ):
                check()
                if time.monotonic() > deadline:
                    raise ghc.GhcError(f"no generator took the schedule within {_DEADLINE:g} s")
                time.sleep(0.02)

        yield wait_until_received
        node.destroy_node()
    finally:
        rclpy.shutdown(context=context)
