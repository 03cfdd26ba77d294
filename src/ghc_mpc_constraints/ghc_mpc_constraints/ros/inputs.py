"""Inputs of a generator node: schedules sent in advance, or a sensor."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from importlib import import_module
from typing import Any

from rclpy.qos import QoSProfile

from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.previews.preview import Preview
from ghc_controller.ros.qos import SCHEDULE_QOS, SENSOR_SUBSCRIBER_QOS
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.ros.wire.timeline import MOST_AHEAD_NS, Timeline
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.generator import Generator, Schedules, Sensor
from ghc_mpc_constraints.ros.conversions import times_of
from ghc_mpc_constraints.ros.tick_clock import TickClock
from ghc_mpc_constraints.schedules.schedule_history import ScheduleHistory
from ghc_mpc_constraints.schedules.schedule_inbox import ScheduleInbox

Reject = Callable[[str, str], None]


class Input(ABC):
    """Input messages of a generator, on one topic."""

    qos: QoSProfile
    newest_only: bool  # keep only the newest message before the first tick

    def __init__(self, given: Schedules | Sensor, clock: TickClock, reject: Reject) -> None:
        self.topic = given.topic
        self.message = message_type(given.message)
        self._clock = clock
        self._reject = reject

    @abstractmethod
    def take(self, message: Any) -> bool:
        """Process a message; returns whether it affects the tick that is due."""

    @abstractmethod
    def begin(self, now: float) -> None:
        """Pass due inputs to the generator before a tick at `now` [s]."""

    @abstractmethod
    def ready(self, start_ns: int) -> bool:
        """Whether all inputs for the tick at `start_ns` [ns] have arrived."""

    @abstractmethod
    def can_take_over(self, in_force: Preview) -> bool:
        """Whether all inputs needed to plan these rows are available."""

    @abstractmethod
    def forget(self) -> None:
        """A new run begins: earlier inputs are stale."""

    @property
    def counts(self) -> dict[str, int]:
        """Counts for the diagnostics."""
        return {}


class ScheduleInput(Input):
    """Keeps schedules until their known_from, and until all of a row have arrived."""

    qos, newest_only = SCHEDULE_QOS, False

    def __init__(
        self,
        given: Schedules,
        generator: Generator,
        parameters: Any,
        clock: TickClock,
        reject: Reject,
    ) -> None:
        super().__init__(given, clock, reject)
        self._given, self._generator = given, generator
        self._names = getattr(parameters, given.names)
        self._inbox = ScheduleInbox(parameters.lockstep)
        self._history = ScheduleHistory()
        self._scheduled: set[str] = set()
        self._accepted = 0  # schedules, including those known later

    def take(self, message: Any) -> bool:
        """Process the schedules of a message; invalid ones are rejected."""
        now, timeline = self._clock.now_ns / NANOSECONDS, self._clock.timeline
        start, known_from = times_of(message, now)
        running = self._clock.tick_ns > (timeline.start_ns or 0)
        known = False
        try:
            _check_run(message, timeline)
            for read in self._given.read(message, start, self._names):
                schedule = read.known_at(known_from)
                at_once = self._inbox.put(schedule, now, running)
                self._accepted += 1
                self._history.arrived(schedule.name, time.monotonic())
                if at_once:
                    self._scheduled.add(schedule.name)
                known = known or at_once
        except GhcError as error:
            self._reject(self.topic, str(error))
        return known

    def begin(self, now: float) -> None:
        """Pass the schedules known by now to the generator."""
        for schedule in self._inbox.due(now, self._has_all_of):
            self._generator.observe(schedule, now)

    def ready(self, start_ns: int) -> bool:  # noqa: ARG002 - schedules are sent in advance
        """Always True: schedules are sent in advance."""
        return True

    def can_take_over(self, in_force: Preview) -> bool:
        """Whether the schedules of all bounded rows have arrived."""
        self._history.expect(in_force.rows)
        complete = [self._has_all_of(row) for row in in_force.rows]
        return all(complete) and set(in_force.rows) <= self._scheduled

    def forget(self) -> None:
        """Discard all schedules: those of the new run have new stamps."""
        self._history.forget()
        self._inbox.forget()
        self._scheduled.clear()

    @property
    def counts(self) -> dict[str, int]:
        """Number of accepted schedules."""
        return {"schedules": self._accepted}

    def _has_all_of(self, row: str) -> bool:
        return self._history.is_complete(row, time.monotonic())


class SensorInput(Input):
    """Passes the newest measurement to the generator; ticks can wait for the measurement of their
    stamp."""

    qos, newest_only = SENSOR_SUBSCRIBER_QOS, True

    def __init__(
        self,
        given: Sensor,
        generator: Generator,
        parameters: Any,
        clock: TickClock,
        reject: Reject,
    ) -> None:
        super().__init__(given, clock, reject)
        self._given, self._generator = given, generator
        self._period_ns = round(parameters.sensor_period * NANOSECONDS)
        self._sensed_ns = -1  # stamp of the newest message
        # A measurement is never from the future, but may arrive before its tick is announced.
        self._ahead_ns = MOST_AHEAD_NS + self._period_ns

    def take(self, message: Any) -> bool:
        """Accept a measurement unless it is from the future or older than the last one."""
        stamp_ns = nanoseconds_from_time(message.header.stamp)
        if stamp_ns > self._clock.now_ns + self._ahead_ns:
            self._reject(
                f"{self.topic}.stamp",
                f"{stamp_ns / NANOSECONDS:.6f} s given, at most {self._ahead_ns / NANOSECONDS:g} s"
                f" after the last tick ({self._clock.now_ns / NANOSECONDS:.6f} s) expected",
            )
            return False
        if stamp_ns <= self._sensed_ns and stamp_ns > 0:
            if stamp_ns < self._sensed_ns:
                given, last = stamp_ns / NANOSECONDS, self._sensed_ns / NANOSECONDS
                self._reject(
                    f"{self.topic}.stamp",
                    f"{given:.6f} s given, at least {last:.6f} s (the last one) expected",
                )
            return False
        try:
            given = self._given.read(message, lambda reason: self._reject(self.topic, reason))
        except GhcError as error:
            self._reject(self.topic, str(error))
            return False
        self._sensed_ns = stamp_ns or self._clock.now_ns
        self._generator.observe(given, self._sensed_ns / NANOSECONDS)
        return True

    def begin(self, now: float) -> None:
        """No effect: a measurement is passed on arrival."""

    def ready(self, start_ns: int) -> bool:
        """Whether the measurement of the last sensor period at or before the tick has arrived."""
        period = self._period_ns
        return period == 0 or self._sensed_ns >= start_ns - start_ns % period

    def can_take_over(self, in_force: Preview) -> bool:  # noqa: ARG002
        """Whether the sensor has sent anything."""
        return self._sensed_ns >= 0

    def forget(self) -> None:
        """Discard the time of the last measurement."""
        self._sensed_ns = -1


def make_input(
    generator: Generator, parameters: Any, clock: TickClock, reject: Reject
) -> ScheduleInput | SensorInput:
    """The input that a generator declares."""
    given = generator.input
    if isinstance(given, Schedules):
        return ScheduleInput(given, generator, parameters, clock, reject)
    return SensorInput(given, generator, parameters, clock, reject)


def _check_run(message: Any, timeline: Timeline) -> None:
    """Raise InvalidValue when the stamp of a schedule is of a run that has ended."""
    stamp_ns = nanoseconds_from_time(message.header.stamp)
    if stamp_ns and timeline.is_stale(stamp_ns):
        raise InvalidValue(
            f"stamp {stamp_ns / NANOSECONDS:g} s given, which is of a run that has ended; one of "
            "the run under way expected"
        )


def message_type(name: str) -> type:
    """Class of a message by its name, such as "ghc_msgs/ContactSchedule".

    Raises:
        InvalidValue: there is no such message.
    """
    package, _, kind = name.partition("/")
    try:
        found: type = getattr(import_module(f"{package}.msg"), kind)
    except (ImportError, AttributeError) as error:
        raise InvalidValue(f"message type '{name}' given: {error}") from error
    return found
