"""The part of the controller node that listens to the constraint generators.

Subscribes constraints/contact_force_bounds (ghc_msgs/ContactForceBounds),
           constraints/obstacle_motion (ghc_msgs/ObstacleStateArray): one plan a tick each.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from ghc_msgs.msg import ContactForceBounds, ObstacleStateArray

from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError, UnknownName
from ghc_controller.ros.conversions.previews import (
    force_bounds_from_message,
    obstacle_motion_from_message,
)
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.types import NANOSECONDS

FORCE_BOUNDS, OBSTACLE_MOTION = "contact_force_bounds", "obstacle_motion"
PLANS: dict[str, type] = {FORCE_BOUNDS: ContactForceBounds, OBSTACLE_MOTION: ObstacleStateArray}

_WAITING = 3  # plans of one generator that are kept; more only wait where ticks are ahead of time
SILENCE = 0.1  # [s] of the robot's time; a generator plans every 10 ms

Message: TypeAlias = "ContactForceBounds | ObstacleStateArray"


class PlanInbox:
    """Keeps plans of each generator until a state at or after their start is answered.

    A malformed plan is refused as a whole, and the one before stays in force. Of a plan for
    contacts or frames of which the robot lacks some, those are left out and the rest is followed.
    """

    def __init__(
        self,
        controller: Controller,
        received: Callable[[str, int, int], None],
        reject: Callable[[str, str], object],
    ) -> None:
        """Hand plans to `controller`.

        Args:
            received: told the name of a plan, its stamp [ns] and its epoch.
            reject: told the field and the reason of a refusal, or of what is left out.
        """
        self._controller = controller
        self._received = received
        self._reject = reject
        self._waiting: dict[str, list[tuple[int, int, Message]]] = {name: [] for name in PLANS}
        self._followed: dict[str, float] = {}  # name -> [s] stamp of the plan in force
        self._ends: dict[str, float] = {}  # name -> [s] end of the plan in force

    def take(self, name: str, message: Message) -> None:
        """Keep a message for the next state."""
        number, start_ns = message.epoch, nanoseconds_from_time(message.header.stamp)
        # Generators plan ahead: one plan may wait for its start and the next for a new epoch.
        self._waiting[name] = [*self._waiting[name][1 - _WAITING :], (number, start_ns, message)]
        self._received(name, start_ns, number)

    def hand_over(self, epoch: int, now_ns: int) -> None:
        """Let the controller follow the newest plans of this epoch that have begun at `now_ns`."""
        for name, waiting in self._waiting.items():
            if not waiting:
                continue
            begun = [message for of, start, message in waiting if of == epoch and start <= now_ns]
            self._waiting[name] = [plan for plan in waiting if plan[:2] > (epoch, now_ns)]
            if not begun:
                continue
            try:
                self._follow(name, begun[-1], now_ns / NANOSECONDS)
            except GhcError as error:
                self._reject(f"constraints/{name}", str(error))

    def forget(self) -> None:
        """Time starts again: no plan is in force."""
        self._followed.clear()

    def silent(self, now: float) -> str:
        """Which generators have not been heard for a while at `now` [s], and what holds then."""
        complaints = []
        for name, stamp in self._followed.items():
            if now - stamp > SILENCE:
                what = "following it" if now <= self._ends[name] else "it has ended: bounds held"
                complaints.append(f"constraints/{name}: last plan {now - stamp:.2f} s old, {what}")
        return "; ".join(complaints)

    def _follow(self, name: str, message: Message, now: float) -> None:
        left_out = self._hand_to_controller(message, now)
        self._followed[name] = nanoseconds_from_time(message.header.stamp) / NANOSECONDS
        self._ends[name] = nanoseconds_from_time(message.valid_until) / NANOSECONDS
        if left_out:
            # A field of its own: it comes with every plan and must not hide what else is refused.
            self._reject(f"constraints/{name}.left_out", "; ".join(map(str, left_out)))

    def _hand_to_controller(self, message: Message, now: float) -> tuple[UnknownName, ...]:
        if isinstance(message, ContactForceBounds):
            return self._controller.force_bounds.follow(force_bounds_from_message(message), now)
        return self._controller.obstacles.follow(obstacle_motion_from_message(message))
