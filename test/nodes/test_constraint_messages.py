"""Plans, schedules and measurements survive the way through their messages."""

from __future__ import annotations

from math import inf, nan
from typing import Any

import numpy as np
import pytest
from ghc_msgs.msg import (
    ContactForceBounds,
    ContactState,
    ControllerState,
    ObstacleState,
    ObstacleStateArray,
    Tick,
)
from rclpy.serialization import deserialize_message, serialize_message

from ghc_controller.contacts import ForceBoundsPlan
from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.previews.motion_plan import MotionPlan
from ghc_controller.ros.conversions.previews import (
    force_bounds_from_message,
    obstacle_motion_from_message,
)
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds
from ghc_controller.ros.wire.cdr import decode_tick, encode_tick
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.force_bounds.contact_force_bounds import ContactForceBounds as Generator
from ghc_mpc_constraints.force_bounds.contact_force_bounds import ForceBoundSettings
from ghc_mpc_constraints.force_bounds.contact_schedule import ContactSchedule
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement
from ghc_mpc_constraints.obstacle_motion.obstacle_bounds import ObstacleBounds, ObstacleSettings
from ghc_mpc_constraints.ros.conversions import (
    bounds_in_force,
    force_bounds_message,
    measurement_from_message,
    measurement_message,
    motion_in_force,
    obstacle_motion_message,
    schedule_from_message,
    schedule_message,
)


@pytest.mark.parametrize(("seconds", "epoch"), [(0, 0), (12, 1), (2**31 - 1, 2**64 - 1)])
def test_a_tick_survives_the_wire(seconds: int, epoch: int) -> None:
    start_ns = seconds * NANOSECONDS + 345_000_006
    message = deserialize_message(encode_tick(start_ns, epoch), Tick)
    assert (nanoseconds_from_time(message.start), message.epoch) == (start_ns, epoch)
    assert decode_tick(bytes(serialize_message(message))) == (start_ns, epoch)
    with pytest.raises(ValueError, match="no Tick"):
        decode_tick(b"\x00\x01\x00")


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
    assert (message.epoch, message.header.frame_id) == (3, "")
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


def _bounds() -> ContactForceBounds:
    """A message that can be used: one contact over two steps."""
    message = ContactForceBounds(step=0.01, points=3, interpolate=True, contacts=["foot"])
    message.header.stamp, message.valid_until = time_from_seconds(1.0), time_from_seconds(1.02)
    message.lower, message.upper = [0.0] * 3, [5.0] * 3
    message.in_contact, message.conflict, message.status = [True], [False], [3]
    return message


def _motion(**fields: Any) -> ObstacleStateArray:
    """A message that can be used: one obstacle over two steps, with `fields` of it changed."""
    entry = ObstacleState(id="box", protected_frame="tool", safe_distance=0.1, status=4)
    entry.normal[:], entry.jerk = [0.0, 0.6, 0.8], [0.0] * 6
    for name, value in fields.items():
        setattr(entry, name, np.array(value) if name == "normal" else value)
    message = ObstacleStateArray(step=0.01, obstacles=[entry])
    message.header.stamp, message.valid_until = time_from_seconds(1.0), time_from_seconds(1.02)
    return message


def _received(message: Any) -> ForceBoundsPlan | MotionPlan:
    """What the controller makes of a message."""
    message = deserialize_message(serialize_message(message), type(message))
    if isinstance(message, ContactForceBounds):
        return force_bounds_from_message(message)
    return obstacle_motion_from_message(message)


def test_the_messages_of_the_next_tests_can_be_used() -> None:
    assert _received(_bounds()).valid_until == pytest.approx(1.02)
    assert _received(_motion()).valid_until == pytest.approx(1.02)
    assert _received(_motion(normal=[0.0, 0.0, 1.0009], safe_distance=0.0, jerk=[])) is not None


def test_an_unknown_status_is_refused_with_those_that_exist() -> None:
    bounds = _bounds()
    bounds.status = [4]
    known = r"0 \(SMOOTHED\), 1 \(RAW\), 2 \(HELD\), 3 \(TIGHTENED\)"
    with pytest.raises(
        InvalidValue, match=f"contact_force_bounds: status 4 given; known: {known}$"
    ):
        _received(bounds)
    with pytest.raises(
        InvalidValue, match=f"'box': status 255 given; known: {known}, 4 \\(STALE\\)$"
    ):
        _received(_motion(status=255))


@pytest.mark.parametrize("step", [1e-310, 0.0, -0.01, 9e-7, 10.1, inf, nan])
def test_a_step_out_of_range_is_refused(step: float) -> None:
    for message in (_bounds(), _motion()):
        message.step = step
        with pytest.raises(InvalidValue, match=f"step {step:g} s given, 1e-06 to 10 s expected"):
            _received(message)


def test_a_plan_that_ends_before_it_starts_is_refused() -> None:
    for message in (_bounds(), _motion()):
        message.valid_until = time_from_seconds(0.75)
        with pytest.raises(InvalidValue, match=r"valid_until 0.25 s before the stamp given"):
            _received(message)


def test_a_plan_of_one_point_is_refused() -> None:
    message = _bounds()
    message.points, message.lower, message.upper = 1, [0.0], [5.0]
    with pytest.raises(InvalidValue, match="points: 1 given, 2 or more expected"):
        _received(message)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"safe_distance": nan}, "safe_distance nan m given, 0 or more expected"),
        ({"safe_distance": inf}, "safe_distance inf m given"),
        ({"safe_distance": -0.1}, "safe_distance -0.1 m given"),
        ({"normal": [0.0, 0.0, 0.0]}, "normal of length 0 given, 1 expected"),
        ({"normal": [0.0, 0.0, 1.01]}, "normal of length 1.01 given"),
        ({"normal": [0.0, nan, 1.0]}, "normal of length nan given"),
        ({"normal": [0.0, inf, 1.0]}, "normal of length inf given"),
        ({"jerk": [0.0] * 5 + [nan]}, "finite numbers expected"),
        ({"jerk": [0.0] * 9}, r"jerk: size 9 given, at most 3 \* 2 expected"),
    ],
)
def test_a_malformed_obstacle_is_refused(fields: dict[str, Any], words: str) -> None:
    with pytest.raises(GhcError, match=f"obstacle 'box'.*{words}"):
        _received(_motion(**fields))


def test_bounds_in_force_of_the_controller() -> None:
    message = ControllerState()
    message.contacts = [
        ContactState(name="left", planned=True, lower=0.0, upper=5.0),
        ContactState(name="hand", on=True, force=3.0),
        ContactState(name="right", planned=True, lower=1.0, upper=6.0),
    ]
    entry = ObstacleState(id="box")
    entry.position[:] = [1.0, 2.0, 3.0]
    entry.acceleration[:] = [4.0, 5.0, 6.0]
    message.obstacles = [entry]
    data = serialize_message(message)
    assert bounds_in_force([data], 0.0) == {"left": (0.0, 5.0), "right": (1.0, 6.0)}
    assert motion_in_force(data, 0.0)["box"].tolist() == [[1, 2, 3], [0, 0, 0], [4, 5, 6]]
    assert motion_in_force(data, 0.02)["box"][1].tolist() == pytest.approx([0.08, 0.1, 0.12])


def _state(stamp: float, lower: float, upper: float) -> bytes:
    message = ControllerState()
    message.contacts = [ContactState(name="foot", planned=True, lower=lower, upper=upper)]
    message.header.stamp = time_from_seconds(stamp)
    return serialize_message(message)


def test_bounds_in_force_that_move_are_continued_to_the_start_of_the_plan() -> None:
    """20 ms after the newest state: as in the 10 ms before, and never below zero."""
    states = [_state(2.99, 3.0, 41.0), _state(3.0, 1.0, 40.0)]
    assert bounds_in_force(states, 3.02)["foot"] == pytest.approx((0.0, 38.0))
    assert bounds_in_force(states, 3.0)["foot"] == (1.0, 40.0)
    assert bounds_in_force(states[1:], 3.02)["foot"] == (1.0, 40.0)
    assert bounds_in_force(states, 4.0)["foot"] == (1.0, 40.0)  # too old to be continued
    assert bounds_in_force([_state(9.0, 3.0, 41.0), states[1]], 3.02)["foot"] == (1.0, 40.0)
