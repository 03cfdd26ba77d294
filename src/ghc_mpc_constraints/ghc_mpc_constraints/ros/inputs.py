"""How the node of a generator takes its input: schedules that are sent ahead, or a sensor."""

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
    """Messages of one topic on their way to the generator."""

    qos: QoSProfile
    newest_only: bool  # of what came before the first tick

    def __init__(self, given: Schedules | Sensor, clock: TickClock, reject: Reject) -> None:
        self.topic = given.topic
        self.message = message_type(given.message)
        self._clock = clock
        self._reject = reject

    @abstractmethod
    def take(self, message: Any) -> bool:
        """Take a message; whether it matters for the tick that is due."""

    @abstractmethod
    def begin(self, now: float) -> None:
        """Hand what is due to the generator before a tick at `now` [s]."""

    @abstractmethod
    def ready(self, start_ns: int) -> bool:
        """Whether all that the tick at `start_ns` [ns] waits for has come."""

    @abstractmethod
    def can_take_over(self, in_force: Preview) -> bool:
        """Whether there is all without which nothing could be planned for these rows."""

    @abstractmethod
    def forget(self) -> None:
        """Another run begins: what came is of one that has ended."""

    @property
    def counts(self) -> dict[str, int]:
        """For the diagnostics."""
        return {}


class ScheduleInput(Input):
    """Holds schedules back until they are known, and until all of a row have come."""

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
        self._accepted = 0  # schedules, also those that are known later

    def take(self, message: Any) -> bool:
        """Take the schedules of a message; a bad one is rejected."""
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
        """Let the generator use the schedules that are known by now."""
        for schedule in self._inbox.due(now, self._has_all_of):
            self._generator.observe(schedule, now)

    def ready(self, start_ns: int) -> bool:  # noqa: ARG002 - schedules come ahead
        """Always: schedules are sent ahead."""
        return True

    def can_take_over(self, in_force: Preview) -> bool:
        """Whether the schedules of all rows in force have come."""
        self._history.expect(in_force.rows)
        complete = [self._has_all_of(row) for row in in_force.rows]
        return all(complete) and set(in_force.rows) <= self._scheduled

    def forget(self) -> None:
        """Forget all schedules: those of the new run carry its stamps."""
        self._history.forget()
        self._inbox.forget()
        self._scheduled.clear()

    @property
    def counts(self) -> dict[str, int]:
        """How many schedules were accepted."""
        return {"schedules": self._accepted}

    def _has_all_of(self, row: str) -> bool:
        return self._history.is_complete(row, time.monotonic())


class SensorInput(Input):
    """Hands the newest measurement to the generator; ticks may wait for that of their stamp."""

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
        # A measurement cannot be of the future; ticks are announced by whoever hears them last.
        self._ahead_ns = MOST_AHEAD_NS + self._period_ns

    def take(self, message: Any) -> bool:
        """Take a measurement unless it is of the future, or older than the last one."""
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
                self._reject(f"{self.topic}.stamp", "older than the last one")
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
        """Nothing: a measurement is handed over when it comes."""

    def ready(self, start_ns: int) -> bool:
        """Whether the measurement of the last sensor period at or before the tick has come."""
        period = self._period_ns
        return period == 0 or self._sensed_ns >= start_ns - start_ns % period

    def can_take_over(self, in_force: Preview) -> bool:  # noqa: ARG002
        """Whether the sensor has said anything."""
        return self._sensed_ns >= 0

    def forget(self) -> None:
        """Forget when it was heard last."""
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
            f"stamp {stamp_ns / NANOSECONDS:g} s given, which is of a run that has ended"
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
