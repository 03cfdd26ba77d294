"""Plans, schedules and measurements survive the way through their messages."""

from __future__ import annotations

import numpy as np
import pytest
from ghc_msgs.msg import ContactForceBounds, ControllerState, ObstacleState, ObstacleStateArray
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState

from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.plan_conversions import force_bounds_from_message, obstacle_motion_from_message
from ghc_controller.ros_conversions import time_from_seconds
from ghc_mpc_constraints.contact_force_bounds import ContactForceBounds as Generator
from ghc_mpc_constraints.contact_force_bounds import ForceBoundSettings
from ghc_mpc_constraints.contact_schedule import ContactSchedule
from ghc_mpc_constraints.measurement import Measurement
from ghc_mpc_constraints.obstacle_bounds import ObstacleBounds, ObstacleSettings
from ghc_mpc_constraints.ros_conversions import (
    bounds_in_force,
    force_bounds_message,
    header_of,
    measurement_from_message,
    measurement_message,
    motion_in_force,
    obstacle_motion_message,
    schedule_from_message,
    schedule_message,
)


@pytest.mark.parametrize("frame", ["", "0", "17", "a longer name than most"])
def test_header_of_serialized_bytes(frame: str) -> None:
    message = JointState(name=["a"], position=[1.0])
    message.header.stamp.sec, message.header.stamp.nanosec = 12, 345_000_006
    message.header.frame_id = frame
    assert header_of(serialize_message(message)) == (12_345_000_006, frame)
    with pytest.raises(InvalidValue, match="no message with a header"):
        header_of(b"\x00\x01\x00")


def test_schedule_round_trip_and_times_from_receipt() -> None:
    schedule = ContactSchedule.checked("foot", [0.5, 2.25], [0.0, 1.0], [5.0, 6.0])
    timed = schedule_from_message(schedule_message(schedule, 1.5), ["foot"], 40.0)
    assert timed.known_from == 1.5
    assert np.allclose(timed.schedule.times, schedule.times, rtol=0.0, atol=2e-9)
    assert timed.schedule.upper.tolist() == [5.0, 6.0]
    relative = schedule_message(schedule)
    relative.header.stamp = time_from_seconds(0.0)
    timed = schedule_from_message(relative, [], 40.0)
    assert timed.known_from is None
    assert timed.schedule.times.tolist() == [40.5, 42.25]


def test_force_bounds_round_trip() -> None:
    generator = Generator(ForceBoundSettings(horizon=0.3))
    for contact, upper in (("left", [5.0, 0.0]), ("right", [7.0, 9.0])):
        generator.set_schedule(
            ContactSchedule.checked(contact, [0.0, 0.2], [0.0, 0.0], upper), 0.0
        )
    plan = generator.tick(0.02)
    message = force_bounds_message(plan, 20_000_000, 3)
    assert message.header.frame_id == "3"
    data = serialize_message(message)
    again = force_bounds_from_message(deserialize_message(data, ContactForceBounds))
    assert again.start == plan.start
    assert again.valid_until == pytest.approx(0.32)
    assert np.array_equal(again.lower, plan.lower)
    assert np.array_equal(again.upper, plan.upper)
    for name in ("contacts", "in_contact", "conflict", "status", "smoothed", "step"):
        assert getattr(again, name) == getattr(plan, name)
    message.upper = message.upper[:-1]
    with pytest.raises(GhcError, match=r"upper: size 61 given, 2 \* 31 expected"):
        force_bounds_from_message(message)
    message.upper = [*message.upper, float("nan")]
    with pytest.raises(GhcError, match="upper: finite numbers expected"):
        force_bounds_from_message(message)
    message.status = []
    with pytest.raises(GhcError, match="status: size 0 given, 2 expected"):
        force_bounds_from_message(message)


def test_obstacle_round_trip() -> None:
    seen = Measurement.checked("box", "tool", [0.1, 0.2, 0.3], [0.0, 0.6, 0.8], 0.25, 0.4)
    message = measurement_message(seen)
    back = measurement_from_message(deserialize_message(serialize_message(message), ObstacleState))
    assert (back.id, back.frame, back.distance, back.safe_distance) == ("box", "tool", 0.25, 0.4)
    assert np.allclose(back.position, seen.position)
    generator = ObstacleBounds(ObstacleSettings(horizon=0.5))
    generator.observe([seen], 0.0)
    for k in range(40):
        plan = generator.tick(0.01 * k)
    sent = obstacle_motion_message(plan, 390_000_000, 0)
    again = obstacle_motion_from_message(
        deserialize_message(serialize_message(sent), ObstacleStateArray)
    )
    assert again.start == pytest.approx(0.39)
    assert again.steps == 50
    for before, after in zip(plan.obstacles, again.obstacles, strict=True):
        assert np.array_equal(before.jerk, after.jerk)
        assert np.array_equal(before.state, after.state)
        assert before.status is after.status
        assert np.allclose(before.at(0.123, 0.01), after.at(0.123, again.step))
    sent.obstacles[0].jerk = sent.obstacles[0].jerk[:-1]
    with pytest.raises(GhcError, match="jerk: size 149 given, a multiple of 3 expected"):
        obstacle_motion_from_message(sent)


def test_bounds_in_force_of_the_controller() -> None:
    message = ControllerState(
        bounded_contacts=["left", "right"], contact_lower=[0.0, 1.0], contact_upper=[5.0, 6.0]
    )
    entry = ObstacleState(id="box")
    entry.position[:] = [1.0, 2.0, 3.0]
    entry.acceleration[:] = [4.0, 5.0, 6.0]
    message.obstacles = [entry]
    data = serialize_message(message)
    assert bounds_in_force(data) == {"left": (0.0, 5.0), "right": (1.0, 6.0)}
    assert motion_in_force(data)["box"].tolist() == [[1, 2, 3], [0, 0, 0], [4, 5, 6]]
