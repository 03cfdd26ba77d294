"""Contact force bounds behind ROS topics: schedules in, a plan of moving bounds out each tick.

Publishes  constraints/contact_force_bounds (stamp and epoch of the tick),
           /diagnostics.
Subscribes ghc/tick (when to plan), constraints/contact_schedule (latched, one message
           a contact), ghc/controller_state (bounds in force, before the first plan).
Parameters see ForceBoundParameters.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from functools import partial

from ghc_msgs.msg import ContactForceBounds as ContactForceBoundsMessage
from ghc_msgs.msg import ContactSchedule
from rclpy.task import Future

from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.ros.qos import PLAN_QOS, SCHEDULE_QOS
from ghc_controller.ros.run import run_node
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.force_bounds.contact_force_bounds import ContactForceBounds
from ghc_mpc_constraints.ros.conversions import (
    bounds_in_force,
    force_bounds_message,
    schedule_from_message,
)
from ghc_mpc_constraints.ros.generator_node import GeneratorNode
from ghc_mpc_constraints.ros.parameters import ForceBoundParameters
from ghc_mpc_constraints.ros.schedule_history import ScheduleHistory
from ghc_mpc_constraints.ros.schedule_inbox import ScheduleInbox

NODE_NAME = "contact_force_bounds"


class ContactForceBoundsNode(GeneratorNode[ForceBoundParameters]):
    """Wires topics to the generator; no arithmetic here."""

    def __init__(self, stop: Future) -> None:
        """Read the parameters, compile, listen.

        Raises:
            GhcError: a parameter cannot be used.
        """
        super().__init__(NODE_NAME, ForceBoundParameters, stop)
        self._generator = ContactForceBounds(self.parameters.settings)
        self._inbox = ScheduleInbox(self.parameters.lockstep)
        self._history = ScheduleHistory()
        self._scheduled: set[str] = set()  # contacts with a schedule
        self._accepted = 0  # schedules, also those that are known later
        self._message = ContactForceBoundsMessage()
        self._plans = self.node.create_publisher(
            ContactForceBoundsMessage, "constraints/contact_force_bounds", PLAN_QOS
        )
        self.listen(
            ContactSchedule, "constraints/contact_schedule", self._on_schedule, SCHEDULE_QOS
        )
        self.start()
        horizon = self._generator.horizon
        self.node.get_logger().info(
            f"{horizon.steps} steps of {horizon.step:g} s, smoothing "
            f"{'on' if self.parameters.settings.smoothing else 'off'}: ready"
        )

    def plan(self, start_ns: int) -> None:
        """Make the plan of a tick and publish it."""
        now = start_ns / NANOSECONDS
        for schedule in self._inbox.due(now, self._has_all_schedules_of):
            self._generator.set_schedule(schedule, now)
        self._generator.hold_handed_over()
        self._message = force_bounds_message(self._generator.tick(now), start_ns, self.clock.epoch)
        self._plans.publish(self._message)

    def publish_again(self) -> None:
        """Publish the last plan once more."""
        self._plans.publish(self._message)

    def reset(self) -> None:
        """Forget plans and schedules: those of the new run carry its stamps."""
        self._generator.reset()
        self._history.forget()
        self._inbox.forget()
        self._scheduled.clear()

    def take_over(self, states: Sequence[bytes], start_ns: int) -> bool:
        """Start from the bounds in force; False while schedules of theirs may still come."""
        in_force = bounds_in_force(states, start_ns / NANOSECONDS)
        for contact, (lower, upper) in in_force.items():
            self._generator.take_over(contact, lower, upper)
        self._history.expect(in_force)
        complete = [self._has_all_schedules_of(contact) for contact in in_force]
        return all(complete) and in_force.keys() <= self._scheduled

    def report(self) -> tuple[Mapping[str, int], int]:
        """Counts, and how many of them are trouble."""
        counts = self._generator.counts
        trouble = counts["held"] + counts["tightened"] + counts["conflicts"]
        more = {"second_opinions": self._generator.second_opinions, "schedules": self._accepted}
        return {**counts, **more}, trouble

    def _has_all_schedules_of(self, contact: str) -> bool:
        return self._history.is_complete(contact, time.monotonic())

    def _on_schedule(self, message: ContactSchedule) -> None:
        self.after_first_tick(partial(self._take_schedule, message))

    def _take_schedule(self, message: ContactSchedule) -> None:
        stamp_ns, timeline = nanoseconds_from_time(message.header.stamp), self.clock.timeline
        if self.waits_for_next_run(stamp_ns, partial(self._take_schedule, message)):
            return
        now = self.clock.now_ns / NANOSECONDS
        running = self.clock.tick_ns > (timeline.start_ns or 0)
        try:
            if stamp_ns and timeline.is_stale(stamp_ns):
                raise InvalidValue(
                    f"schedule of contact '{message.contact}': stamp {stamp_ns / NANOSECONDS:g} s "
                    "given, which is of a run that has ended"
                )
            timed = schedule_from_message(message, self.parameters.contacts, now)
            known = self._inbox.put(timed, now, running)
            self._accepted += 1
            self._history.arrived(timed.schedule.contact, time.monotonic())
            if known:
                self._scheduled.add(timed.schedule.contact)
                self.look_again()
        except GhcError as error:
            self.reject("constraints/contact_schedule", str(error))


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal; exit code 0, 1 (failed while running) or 2 (refused)."""
    return run_node(NODE_NAME, ContactForceBoundsNode, args)


if __name__ == "__main__":
    sys.exit(main())
