"""Plans, schedules and measurements survive the way through their messages."""

from __future__ import annotations

from math import inf, nan
from typing import Any

import numpy as np
import pytest
from ghc_msgs.msg import (
    BoundInForce,
    ConstraintPreview,
    ConstraintPreviews,
    ContactState,
    ControllerState,
    ObstacleState,
    PlannedMotion,
    Tick,
)
from rclpy.serialization import deserialize_message, serialize_message

from ghc_controller.errors import GhcError, InvalidValue, UnknownName
from ghc_controller.previews.preview import Preview, StaleRule
from ghc_controller.ros.conversions.previews import preview_from_message, previews_message
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds
from ghc_controller.ros.wire.cdr import decode_tick, encode_tick
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.generators.contact_forces import ContactForceBounds as Generator
from ghc_mpc_constraints.generators.contact_forces import ForceBoundSettings
from ghc_mpc_constraints.generators.obstacle_motion import ObstacleBounds, ObstacleSettings
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement
from ghc_mpc_constraints.ros.conversions import (
    in_force,
    measurement_message,
    schedule_message,
    times_of,
)
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule


@pytest.mark.parametrize(("seconds", "epoch"), [(0, 0), (12, 1), (2**31 - 1, 2**64 - 1)])
def test_a_tick_survives_the_wire(seconds: int, epoch: int) -> None:
    start_ns = seconds * NANOSECONDS + 345_000_006
    message = deserialize_message(encode_tick(start_ns, epoch), Tick)
    assert (nanoseconds_from_time(message.start), message.epoch) == (start_ns, epoch)
    assert decode_tick(bytes(serialize_message(message))) == (start_ns, epoch)
    with pytest.raises(ValueError, match="no Tick"):
        decode_tick(b"\x00\x01\x00")


def test_schedule_round_trip_and_times_from_receipt() -> None:
    schedule = ContactSchedule.checked("foot", [0.5, 2.25], [0.0, 1.0], [5.0, 6.0], known_from=1.5)
    message = schedule_message(schedule)
    start, known_from = times_of(message, 40.0)
    assert known_from == 1.5
    (again,) = ContactSchedule.read(message, start, ["foot"])
    assert np.allclose(again.times, schedule.times, rtol=0.0, atol=2e-9)
    assert again.upper.tolist() == [5.0, 6.0]
    relative = schedule_message(schedule.known_at(None))
    relative.header.stamp = time_from_seconds(0.0)
    start, known_from = times_of(relative, 40.0)
    assert known_from is None
    assert ContactSchedule.read(relative, start)[0].times.tolist() == [40.5, 42.25]


def test_limit_schedule_round_trip_of_several_joints() -> None:
    one = LimitSchedule.checked("joint_1", [0.0, 2.0], [-1.0, -0.5], [1.0, 0.5])
    message = deserialize_message(
        serialize_message(schedule_message(one)), type(schedule_message(one))
    )
    message.names = ["joint_1", "joint_2"]
    message.lower = [*message.lower, -3.0, -2.0]
    message.upper = [*message.upper, 3.0, 2.0]
    first, second = LimitSchedule.read(message, 10.0)
    assert (first.name, second.name) == ("joint_1", "joint_2")
    assert first.lower.tolist() == [-1.0, -0.5]
    assert second.upper.tolist() == [3.0, 2.0]
    assert second.times.tolist() == [10.0, 12.0]
    with pytest.raises(UnknownName, match="unknown joint 'joint_2'; known: joint_1"):
        LimitSchedule.read(message, 0.0, ["joint_1"])
    message.upper = message.upper[:-1]
    with pytest.raises(GhcError, match=r"upper: size 3 given, 2 \* 2 expected"):
        LimitSchedule.read(message, 0.0)
    message.names = ["joint_1", "joint_1"]
    with pytest.raises(InvalidValue, match="each once, expected"):
        LimitSchedule.read(message, 0.0)


def _sent(plan: Preview, epoch: int = 0) -> Any:
    """The only preview of a message that came, and the message."""
    data = serialize_message(previews_message((plan,), round(plan.start * 1e9), epoch))
    message = deserialize_message(data, ConstraintPreviews)
    (preview,) = message.previews
    return preview, message


def test_force_bounds_round_trip() -> None:
    generator = Generator(ForceBoundSettings(horizon=0.3))
    for contact, upper in (("left", [5.0, 0.0]), ("right", [7.0, 9.0])):
        generator.observe(ContactSchedule.checked(contact, [0.0, 0.2], [0.0, 0.0], upper), 0.0)
    plan = generator.tick(0.02).labeled("contact_forces", StaleRule.TIGHTEN, "a generator")
    message, whole = _sent(plan, 3)
    assert (whole.epoch, whole.header.frame_id) == (3, "")
    again = preview_from_message(message, plan.start)
    assert again.valid_until == pytest.approx(0.32)
    assert np.array_equal(again.lower, plan.lower)
    assert np.array_equal(again.upper, plan.upper)
    for name in ("kind", "rows", "active", "conflict", "status", "interpolate", "step"):
        assert getattr(again, name) == getattr(plan, name)
    assert (again.stale, again.name) == (StaleRule.TIGHTEN, "a generator")
    message.upper = message.upper[:-1]
    with pytest.raises(GhcError, match=r"upper: size 61 given, 2 \* 31 expected"):
        preview_from_message(message, 0.0)
    message.upper = [*message.upper, float("nan")]
    with pytest.raises(GhcError, match="upper: nan given, finite numbers expected"):
        preview_from_message(message, 0.0)
    message.status = []
    with pytest.raises(GhcError, match="status: size 0 given, 2 expected"):
        preview_from_message(message, 0.0)


def test_obstacle_round_trip() -> None:
    seen = Measurement.checked("box", "tool", [0.1, 0.2, 0.3], [0.0, 0.6, 0.8], 0.25, 0.4)
    message = measurement_message(seen)
    back = Measurement.read(deserialize_message(serialize_message(message), ObstacleState))
    assert (back.id, back.frame, back.distance, back.safe_distance) == ("box", "tool", 0.25, 0.4)
    assert np.allclose(back.position, seen.position)
    generator = ObstacleBounds(ObstacleSettings(horizon=0.5))
    generator.observe([seen], 0.0)
    for k in range(40):
        plan = generator.tick(0.01 * k)
    sent, _ = _sent(plan)
    again = preview_from_message(sent, plan.start)
    assert again.start == pytest.approx(0.39)
    assert again.lower.shape == (1, 51)
    for before, after in zip(plan.motions, again.motions, strict=True):
        assert np.array_equal(before.jerk, after.jerk)
        assert np.array_equal(before.state, after.state)
        assert before.status is after.status
        assert np.allclose(before.at(0.123, 0.01), after.at(0.123, again.step))
    sent.motions[0].jerk = sent.motions[0].jerk[:-1]
    with pytest.raises(GhcError, match="jerk: size 149 given, a multiple of 3 expected"):
        preview_from_message(sent, plan.start)


def _bounds() -> ConstraintPreview:
    """A message that can be used: one contact over two steps."""
    message = ConstraintPreview(
        kind="contact_forces", step=0.01, points=3, interpolate=True, rows=["foot"]
    )
    message.lower, message.upper = [0.0] * 3, [5.0] * 3
    message.active, message.conflict, message.status = [True], [False], [3]
    return message


def _motion(**fields: Any) -> ConstraintPreview:
    """A message that can be used: one obstacle over two steps, with `fields` of it changed."""
    entry = PlannedMotion(id="box", protected_frame="tool", safe_distance=0.1, status=4)
    entry.normal[:], entry.jerk = [0.0, 0.6, 0.8], [0.0] * 6
    for name, value in fields.items():
        setattr(entry, name, np.array(value) if name == "normal" else value)
    return ConstraintPreview(kind="obstacle_motion", step=0.01, points=3, motions=[entry])


def _received(message: ConstraintPreview) -> Preview:
    """What the controller makes of a message."""
    data = serialize_message(message)
    return preview_from_message(deserialize_message(data, ConstraintPreview), 1.0)


def test_the_messages_of_the_next_tests_can_be_used() -> None:
    assert _received(_bounds()).valid_until == pytest.approx(1.02)
    assert _received(_motion()).valid_until == pytest.approx(1.02)
    assert _received(_motion(normal=[0.0, 0.0, 1.0009], safe_distance=0.0, jerk=[])) is not None


def test_an_unknown_status_or_stale_rule_is_rejected_with_those_that_exist() -> None:
    bounds = _bounds()
    bounds.status = [5]
    known = r"0 \(SMOOTHED\), 1 \(RAW\), 2 \(HELD\), 3 \(TIGHTENED\), 4 \(STALE\)"
    with pytest.raises(InvalidValue, match=f"contact_forces: status 5 given; known: {known}$"):
        _received(bounds)
    with pytest.raises(InvalidValue, match=f"'box': status 255 given; known: {known}$"):
        _received(_motion(status=255))
    bounds = _bounds()
    bounds.stale_rule = 9
    with pytest.raises(InvalidValue, match=r"stale_rule 9 given; known: 0 \(OF_ROBOT\)"):
        _received(bounds)


@pytest.mark.parametrize("step", [1e-310, 0.0, -0.01, 9e-7, 10.1, inf, nan])
def test_a_step_out_of_range_is_refused(step: float) -> None:
    for message in (_bounds(), _motion()):
        message.step = step
        with pytest.raises(InvalidValue, match=f"step {step:g} s given, 1e-06 to 10 s expected"):
            _received(message)


@pytest.mark.parametrize("points", [0, 1, 2**32 - 1])
def test_a_plan_of_one_point_or_of_too_many_is_refused(points: int) -> None:
    for message in (_bounds(), _motion()):
        message.points = points
        with pytest.raises(InvalidValue, match=f"points: {points} given, 2 to 100000 expected"):
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


def _of(preview: Preview) -> dict[str, tuple[float, float]]:
    return {row: (preview.lower[i, 0], preview.upper[i, 0]) for i, row in enumerate(preview.rows)}


def test_bounds_in_force_of_the_controller() -> None:
    message = ControllerState()
    message.contacts = [
        ContactState(name="left", planned=True, lower=0.0, upper=5.0),
        ContactState(name="hand", on=True, force=3.0),
        ContactState(name="right", planned=True, lower=1.0, upper=6.0),
    ]
    entry = PlannedMotion(id="box")
    entry.position[:] = [1.0, 2.0, 3.0]
    entry.acceleration[:] = [4.0, 5.0, 6.0]
    message.obstacles = [entry]
    message.bounds = [
        BoundInForce(kind="joint_limits", row="elbow", lower=-1.0, upper=2.0),
        BoundInForce(kind="torque_limits", row="elbow", lower=-30.0, upper=40.0),
    ]
    data = [serialize_message(message)]
    assert _of(in_force(data, 0.0, "contact_forces")) == {"left": (0.0, 5.0), "right": (1.0, 6.0)}
    assert _of(in_force(data, 0.0, "joint_limits")) == {"elbow": (-1.0, 2.0)}
    assert _of(in_force(data, 0.0, "torque_limits")) == {"elbow": (-30.0, 40.0)}
    (box,) = in_force(data, 0.0, "obstacle_motion").motions
    assert box.state.tolist() == [[1, 2, 3], [0, 0, 0], [4, 5, 6]]
    (box,) = in_force(data, 0.02, "obstacle_motion").motions
    assert box.state[1].tolist() == pytest.approx([0.08, 0.1, 0.12])


def _state(stamp: float, lower: float, upper: float) -> bytes:
    message = ControllerState()
    message.contacts = [ContactState(name="foot", planned=True, lower=lower, upper=upper)]
    message.header.stamp = time_from_seconds(stamp)
    return serialize_message(message)


def _foot(states: list[bytes], time: float) -> tuple[float, float]:
    return _of(in_force(states, time, "contact_forces"))["foot"]


def test_bounds_in_force_that_move_are_continued_to_the_start_of_the_plan() -> None:
    """20 ms after the newest state: as in the 10 ms before, and never below zero."""
    states = [_state(2.99, 3.0, 41.0), _state(3.0, 1.0, 40.0)]
    assert _foot(states, 3.02) == pytest.approx((0.0, 38.0))
    assert _foot(states, 3.0) == (1.0, 40.0)
    assert _foot(states[1:], 3.02) == (1.0, 40.0)
    assert _foot(states, 4.0) == (1.0, 40.0)  # too old to be continued
    assert _foot([_state(9.0, 3.0, 41.0), states[1]], 3.02) == (1.0, 40.0)
