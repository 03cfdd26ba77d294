"""The generators as processes: a plan for every tick, repeats alike, bad input rejected."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import (
    ConstraintPreview,
    ConstraintPreviews,
    ContactSchedule,
    ContactState,
    ControllerState,
    Epoch,
    ObstacleState,
    ObstacleStateArray,
    PlannedMotion,
    Tick,
)
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from ghc_controller.previews.preview import Preview
from ghc_controller.ros.conversions.previews import preview_from_message
from ghc_controller.ros.qos import (
    CONTROL_PUBLISHER_QOS,
    LATCHED_QOS,
    PREVIEW_QOS,
    SCHEDULE_QOS,
    SENSOR_PUBLISHER_QOS,
    STREAM_QOS,
)
from ghc_controller.ros.time import nanoseconds_from_time, seconds_from_time, time_from_seconds
from ghc_controller.ros.wire.epochs import EPOCH_TOPIC
from ghc_mpc_constraints.generators.contact_forces import ContactForceBounds as Generator
from ghc_mpc_constraints.generators.contact_forces import ForceBoundSettings
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement
from ghc_mpc_constraints.ros.conversions import measurement_message, schedule_message
from ghc_mpc_constraints.schedules import contact_schedule

DEADLINE = 90.0  # [s] wall, for anything that must happen
STEP = 0.01  # [s]


class Planned:
    """A message of one preview; its fields stand for those of the preview."""

    def __init__(self, message: ConstraintPreviews) -> None:
        self.message, self.header = message, message.header
        (self.preview,) = message.previews

    def __getattr__(self, name: str) -> Any:
        return getattr(self.preview, name)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Planned) and self.message == other.message

    def value(self) -> Preview:
        """The preview as the controller takes it."""
        return preview_from_message(self.preview, seconds_from_time(self.header.stamp))


class Surroundings:
    """What a generator talks to: robot, planner, sensor and controller in one node."""

    def __init__(self, context: Any) -> None:
        self.node = Node("surroundings", context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.reports = 0  # diagnostics that came
        self.plans: list[Planned] = []
        self.diagnostics: dict[str, str] = {}
        self.epoch = 0
        create, listen = self.node.create_publisher, self.node.create_subscription
        self.ticks = create(Tick, "ghc/tick", CONTROL_PUBLISHER_QOS)
        self.epochs = create(Epoch, EPOCH_TOPIC, LATCHED_QOS)
        self.schedules = create(ContactSchedule, "constraints/contact_schedule", SCHEDULE_QOS)
        self.sensor = create(ObstacleStateArray, "constraints/obstacles", SENSOR_PUBLISHER_QOS)
        self.controller = create(ControllerState, "ghc/controller_state", STREAM_QOS)

        def keep(message: ConstraintPreviews) -> None:
            self.plans.append(Planned(message))

        listen(ConstraintPreviews, "constraints/preview", keep, PREVIEW_QOS)
        listen(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        self.reports += 1
        for status in message.status:
            self.diagnostics = {pair.key: pair.value for pair in status.values}
            self.diagnostics["summary"] = status.message

    def until(
        self, condition: Callable[[], bool], again: Callable[[], None] | None = None
    ) -> None:
        """Spin until `condition`, doing `again` every 0.1 s; fail after the deadline."""
        deadline, due = time.monotonic() + DEADLINE, 0.0
        while not condition():
            assert time.monotonic() < deadline, "nothing came"
            if again is not None and time.monotonic() > due:
                again()
                due = time.monotonic() + 0.1
            self._executor.spin_once(timeout_sec=0.02)

    def spin(self, seconds: float) -> None:
        """Let things happen for a while [s]."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)

    def announce(self, now: float) -> None:
        """Publish one tick as the controller does."""
        self.ticks.publish(Tick(start=time_from_seconds(now), epoch=self.epoch))

    def tick(self, now: float, again: Callable[[], None] | None = None) -> Any:
        """The plan of a tick (announced again until it comes)."""
        count = len(self.plans)
        wanted = nanoseconds_from_time(time_from_seconds(now))

        def publish() -> None:
            if again is not None:
                again()
            self.announce(now)

        def answered() -> bool:
            return any(
                nanoseconds_from_time(plan.header.stamp) == wanted
                and plan.message.epoch == self.epoch
                for plan in self.plans[count:]
            )

        self.until(answered, publish)
        return self.plans[-1]

    def schedule(self, times: list[float], upper: list[float], **change: Any) -> None:
        """Publish a schedule of the contact `foot` with no smallest force."""
        message = schedule_message(
            contact_schedule.ContactSchedule.checked("foot", [0.0], [0.0], [1.0])
        )
        message.times, message.lower, message.upper = times, [0.0] * len(times), upper
        message.header.stamp = change.pop("stamp", message.header.stamp)
        for name, value in change.items():
            setattr(message, name, value)
        self.schedules.publish(message)

    def sense(self, now: float, *distances: float) -> None:
        """Publish obstacles box_0, box_1, ... ahead of a frame at the origin."""
        message = ObstacleStateArray()
        message.header.stamp = time_from_seconds(now)
        message.obstacles = [
            measurement_message(
                Measurement.checked(f"box_{i}", "tool", [d, 0.0, 0.0], [-1.0, 0.0, 0.0], d, 0.4)
            )
            for i, d in enumerate(distances)
        ]
        self.sensor.publish(message)


@pytest.fixture
def world(ros_context: Any) -> Iterator[Surroundings]:
    surroundings = Surroundings(ros_context)
    yield surroundings
    surroundings.node.destroy_node()


@pytest.fixture
def start(world: Surroundings, start_node: Callable[..., Any]) -> Callable[..., Any]:
    """Start a generator with parameters and wait until it is connected."""

    def start(executable: str, **parameters: Any) -> Any:
        words = [w for n, v in parameters.items() for w in ("-p", f"{n}:={v}")]
        node = start_node("ghc_mpc_constraints", executable, "--ros-args", *words)
        node.wait_for_output("ready")
        topic = world.schedules if executable == "contact_force_bounds" else world.sensor
        world.until(
            lambda: (
                world.ticks.get_subscription_count() > 0
                and topic.get_subscription_count() > 0
                and world.controller.get_subscription_count() > 0
                and world.node.count_publishers("constraints/preview") > 0
            )
        )
        return node

    return start


def _bounded(lower: float, upper: float) -> ControllerState:
    """What the controller says of the contact `foot`."""
    foot = ContactState(name="foot", planned=True, lower=lower, upper=upper)
    return ControllerState(contacts=[foot])


def _foot(times: list[float], upper: list[float]) -> contact_schedule.ContactSchedule:
    return contact_schedule.ContactSchedule.checked("foot", times, [0.0] * len(times), upper)


def test_a_plan_for_every_tick_equal_to_the_library(world: Surroundings, start: Any) -> None:
    """40 ticks through a drop: bit for bit what the generator gives in this process."""
    start("contact_force_bounds", horizon=0.5, lockstep="true")
    assert world.tick(0.0).rows == []
    world.schedule([0.0, 0.3], [50.0, 0.0])
    world.until(lambda: world.plans[-1].rows == ["foot"], lambda: world.announce(0.0))
    generator = Generator(ForceBoundSettings(horizon=0.5))
    generator.observe(_foot([1e-9, 0.3 + 1e-9], [50.0, 0.0]), 0.0)
    for k in range(40):
        plan = world.tick(k * STEP).value()
        expected = generator.tick(k * STEP)
        assert np.array_equal(plan.upper, expected.upper)
        assert np.array_equal(plan.lower, expected.lower)
        assert plan.active == (k < 30,)
        assert plan.valid_until == pytest.approx(k * STEP + 0.5)


def test_a_repeated_tick_gets_the_same_plan_and_others_none(
    world: Surroundings, start: Any
) -> None:
    start("contact_force_bounds", horizon=0.5)
    world.schedule([0.0, 0.3], [50.0, 20.0])
    world.tick(0.0)
    world.until(lambda: world.plans[-1].rows == ["foot"], lambda: world.announce(0.0))
    first = world.tick(0.01)
    assert world.tick(0.01) == first
    world.announce(0.015)
    world.tick(0.02)  # what 0.015 had caused would have come before it
    stamps = {nanoseconds_from_time(plan.header.stamp) for plan in world.plans}
    assert stamps == {0, 10_000_000, 20_000_000}
    world.until(  # the tick of 0.03 was missed: it is made up for
        lambda: nanoseconds_from_time(world.plans[-1].header.stamp) == 30_000_000,
        lambda: world.announce(0.037),
    )
    world.epoch = 1  # the robot starts again
    assert world.tick(0.0).rows == []


BAD: list[tuple[dict[str, Any], str]] = [
    ({"times": [0.0, 0.2, 0.1], "upper": [5.0] * 3}, "increasing times expected"),
    ({"times": [0.0], "upper": [5.0], "contact": "hand"}, "unknown contact 'hand'; known: foot"),
    ({"times": [0.0], "upper": [float("nan")]}, "upper[0] = nan given, a finite number expected"),
    ({"times": [0.0], "upper": [-5.0]}, "upper[0] = -5 N given, 0 or more expected"),
    ({"times": [], "upper": []}, "no times given, at least one expected"),
    ({"times": [0.0, 1.0], "upper": [5.0]}, "upper: size 1 given, 2 expected"),
    ({"times": [5.0], "upper": [5.0]}, "no known_from given, later than 0.11 s (now) expected"),
]


def test_bad_schedules_are_refused_and_the_plan_stays(world: Surroundings, start: Any) -> None:
    """The reason in the log, a count in the diagnostics, the bounds as before."""
    node = start("contact_force_bounds", horizon=0.5, lockstep="true", contacts="[foot]")
    world.tick(0.0)
    world.schedule([0.0], [37.0])
    world.until(lambda: world.plans[-1].rows == ["foot"], lambda: world.announce(0.0))
    world.tick(0.05)
    for number, (fields, reason) in enumerate(BAD):
        world.spin(1.05)  # at most one warning a second
        world.schedule(**fields)
        node.wait_for_output(reason)
        plan = world.tick(0.06 + number * STEP)
        assert set(plan.upper) == {37.0}
    name = "rejected_constraints/contact_schedule"
    world.until(lambda: world.diagnostics.get(name) == str(len(BAD)))
    assert f"{len(BAD)} rejected" in world.diagnostics["summary"]


def test_a_schedule_is_used_from_the_time_at_which_it_is_known(
    world: Surroundings, start: Any
) -> None:
    """A surprise, scripted: sent at the start, looked at from 0.1 s on."""
    start("contact_force_bounds", horizon=0.5, lockstep="true")
    world.tick(0.0)
    world.schedule([0.0], [40.0])
    world.schedule([0.3], [10.0], known_from=time_from_seconds(0.1))
    world.until(lambda: world.plans[-1].rows == ["foot"], lambda: world.announce(0.0))
    last = [world.tick(k * STEP).upper[-1] for k in range(12)]
    assert last[:10] == [40.0] * 10
    assert last[10:] == [10.0] * 2


def test_every_run_is_planned_alike_and_stale_schedules_are_refused(
    world: Surroundings, start: Any
) -> None:
    """The script is sent before the first tick of its run, with its stamps; one is known later."""
    node = start("contact_force_bounds", horizon=0.5, lockstep="true")
    runs = []
    for epoch, began in enumerate((0.0, 2.0, 7.0)):
        world.epochs.publish(Epoch(start=time_from_seconds(began), number=epoch))
        assert world.epochs.wait_for_all_acked(Duration(seconds=DEADLINE))
        if epoch == 0:
            world.tick(began)
        else:
            world.spin(0.2)
        world.epoch = epoch
        stamp = time_from_seconds(max(began, 1e-9))
        known = time_from_seconds(began + 0.15)
        world.schedule([0.0, 0.1, 0.2], [40.0, 0.0, 40.0], stamp=stamp)
        world.schedule([0.25], [10.0], stamp=stamp, known_from=known)
        world.until(lambda: world.plans[-1].rows == ["foot"], partial(world.announce, began))
        runs.append([world.tick(began + k * STEP) for k in range(30)])
    for first, *others in zip(*runs, strict=True):
        for other in others:
            assert list(other.active) == list(first.active)
            np.testing.assert_allclose(other.lower, first.lower, atol=1e-9)
            np.testing.assert_allclose(other.upper, first.upper, rtol=1e-9, atol=1e-9)
    assert runs[2][0].upper[0] == 40.0
    assert runs[2][14].upper[-1] > 20.0
    assert runs[2][15].upper[-1] <= 10.0
    world.schedule([0.0], [3.0], stamp=time_from_seconds(2.5))
    node.wait_for_output("stamp 2.5 s given, which is of a run that has ended")


def test_a_restarted_generator_takes_over_from_the_bound_in_force(
    world: Surroundings, start: Any
) -> None:
    """Killed at 0.2 s while the bound moves; the next one goes on where the controller is."""
    node = start("contact_force_bounds", horizon=0.5)
    world.schedule([0.0, 0.3], [50.0, 0.0])
    world.until(lambda: world.tick(0.0).rows == ["foot"])
    for k in range(21):
        plan = world.tick(k * STEP).value()
    node.send(signal.SIGKILL)
    node.wait()
    start("contact_force_bounds", horizon=0.5, take_over_timeout=10.0)
    lower, upper = plan.at(0.25)
    in_force = _bounded(float(lower[0]), float(upper[0]))
    again = world.tick(0.25, lambda: world.controller.publish(in_force))
    assert again.upper[0] == pytest.approx(upper[0], abs=1e-12)
    assert 0.0 < again.upper[0] < 40.0


def test_a_restarted_generator_does_not_follow_a_schedule_that_was_replaced(
    world: Surroundings, start: Any
) -> None:
    """The topic keeps both; the second comes 0.1 s after the first, while ticks go on."""
    node = start("contact_force_bounds", horizon=0.5, take_over_timeout=10.0)
    in_force = _bounded(0.0, 20.0)
    begun = time.monotonic()
    sent = 0
    while not world.plans:
        assert time.monotonic() < begun + DEADLINE, node.output
        if sent < 2 and time.monotonic() > begun + 0.1 * sent:
            world.schedule([0.0], [(60.0, 20.0)[sent]])
            sent += 1
        world.controller.publish(in_force)
        world.announce(5.0 + round(time.monotonic() - begun, 2))
        world.spin(0.01)
    assert set(world.plans[0].upper) == {20.0}


def test_a_contact_that_nobody_schedules_any_more_stays_as_it_is(
    world: Surroundings, start: Any
) -> None:
    """The planner has gone as well: the current bounds, not those of the robot's file."""
    start("contact_force_bounds", horizon=0.5, take_over_timeout=3.0)
    in_force = _bounded(0.0, 20.0)
    plan = world.tick(5.0, lambda: world.controller.publish(in_force))
    assert plan.rows == ["foot"]
    assert set(plan.upper) == {20.0}


def test_without_a_controller_it_starts_from_raw(world: Surroundings, start: Any) -> None:
    start("contact_force_bounds", horizon=0.5, take_over_timeout=0.2)
    world.schedule([0.0], [50.0])
    world.until(lambda: world.tick(3.0).rows == ["foot"])
    assert world.plans[-1].upper[0] == 50.0


@pytest.mark.parametrize("executor", ["events", "single"])
def test_smoothing_off_passes_through(world: Surroundings, start: Any, executor: str) -> None:
    start("contact_force_bounds", horizon=0.5, smoothing="false", executor=executor)
    world.schedule([0.0, 0.05], [50.0, 5.0])
    world.until(lambda: world.tick(0.0).rows == ["foot"])
    for k in range(10):
        plan = world.tick(k * STEP)
        assert not plan.interpolate
        assert plan.upper[0] == (50.0 if k < 5 else 5.0)
        assert plan.status[0] == ConstraintPreview.RAW


def test_obstacles_from_sensor_to_motion(world: Surroundings, start: Any) -> None:
    """One array a tick, empty ones too; ticks of the sensor wait for it; it comes and goes."""
    start("obstacle_bounds", sensor_period=0.1, horizon=0.5, max_velocity=1.0)
    world.until(lambda: world.reports > 0)
    world.announce(0.0)
    heard = world.reports
    world.until(lambda: world.reports >= heard + 2)  # it was at work since: a plan would be here
    assert world.plans == []
    assert world.tick(0.0, lambda: world.sense(0.0)).motions == []
    for k in range(1, 10):
        assert world.tick(k * STEP).motions == []
    distances = []
    for k in range(10, 160):
        seen = [0.25] if k < 80 else []

        def sense(now: float = k * STEP, seen: tuple[float, ...] = tuple(seen)) -> None:
            world.sense(now, *seen)

        plan = world.tick(k * STEP, None if k % 10 else sense).value()
        distances.append(plan.motions[0].state[0, 0] if plan.motions else np.inf)
    assert distances[0] == pytest.approx(0.45)
    assert distances[35] <= 0.25 + 1e-8  # 0.3 s of reaction time at least
    assert np.abs(np.diff(distances[:70])).max() < 0.03
    assert distances[-1] == np.inf


def test_a_bad_obstacle_is_left_out_with_a_reason(world: Surroundings, start: Any) -> None:
    """Its neighbors go on; itself it stays where it was."""
    node = start("obstacle_bounds", horizon=0.5)
    world.until(lambda: len(world.tick(0.0).motions) == 2, lambda: world.sense(0.0, 0.3, 0.35))
    message = ObstacleStateArray()
    message.header.stamp = time_from_seconds(0.1)
    bad = ObstacleState(id="box_0", protected_frame="tool", safe_distance=0.4, distance=0.3)
    good = measurement_message(
        Measurement.checked("box_1", "tool", [0.3, 0.0, 0.0], [-1.0, 0.0, 0.0], 0.3, 0.4)
    )
    message.obstacles = [bad, good]
    world.sensor.publish(message)
    node.wait_for_output("obstacle 'box_0': normal of length 0 given, 1 expected")
    assert [o.id for o in world.tick(0.1).motions] == ["box_0", "box_1"]
    world.until(lambda: world.diagnostics.get("rejected_constraints/obstacles") == "1")


def test_a_restarted_generator_takes_over_the_motion_in_force(
    world: Surroundings, start: Any
) -> None:
    start("obstacle_bounds", horizon=0.5, sensor_period=0.1)
    entry = PlannedMotion(id="box_0")
    entry.position[:], entry.velocity[:] = [0.33, 0.0, 0.0], [-0.1, 0.0, 0.0]
    in_force = ControllerState(obstacles=[entry])

    def feed() -> None:
        world.controller.publish(in_force)
        world.sense(2.0, 0.25)

    plan = world.tick(2.0, feed)
    assert list(plan.motions[0].position) == pytest.approx([0.33, 0.0, 0.0])
    assert list(plan.motions[0].velocity) == pytest.approx([-0.1, 0.0, 0.0])


@pytest.mark.parametrize(
    ("executable", "parameter", "reason"),
    [
        ("contact_force_bounds", "horizon:=0.015", "a multiple of the step (0.01 s)"),
        ("contact_force_bounds", "upper_rate_weight:=0.0", "a number above 0 expected"),
        ("contact_force_bounds", "alpha:=0.1", "unknown parameter 'alpha'"),
        ("obstacle_bounds", "max_velocity:=-1.0", "a number above 0 expected"),
    ],
)
def test_bad_parameters_end_the_node_with_one_line(
    start_node: Callable[..., Any], executable: str, parameter: str, reason: str
) -> None:
    node = start_node("ghc_mpc_constraints", executable, "--ros-args", "-p", parameter)
    assert node.wait(DEADLINE) == 2
    assert reason in node.output
    assert "Traceback" not in node.output


@pytest.mark.parametrize("executable", ["contact_force_bounds", "obstacle_bounds"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_the_node_in_order(
    start: Any, executable: str, number: signal.Signals
) -> None:
    node = start(executable)
    node.send(number)
    assert node.wait() == 0
    assert "Traceback" not in node.output
