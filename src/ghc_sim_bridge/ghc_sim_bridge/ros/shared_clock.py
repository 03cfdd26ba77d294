"""One clock on a network: of several bridges, each with its own robot, one publishes /clock."""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.node import Node
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from ghc_controller.ros.qos import CLOCK_QOS
from ghc_controller.ros.wire.cdr import STAMP_END, read_stamp
from ghc_sim_bridge.ros.others import CLOCK, LISTENING, first_message, other_publishers

SILENCE = 5.0  # [s] wall without the clock of another: it has ended
LOOKS = 5  # [-] looks after another publisher has come, while which it is listened to


class SharedClock:
    """Says whether this bridge publishes the clock, so that it never goes back.

    Whoever has it keeps it. Of two that start at once the first by name has it; if they find out
    too late, the one that is behind leaves it. Who does not have it takes it when it has fallen
    silent and the bridge's own time has passed what was heard last.
    """

    def __init__(self, node: Node, now_ns: Callable[[], int]) -> None:
        """`node` has a publisher of the clock already; `now_ns` gives the bridge's time [ns]."""
        self.owned = True
        self._node = node
        self._now_ns = now_ns
        self._heard_ns = -1  # [ns] latest time of another's clock
        self._heard_at = time.monotonic()  # [s] wall
        self._known: tuple[str, ...] = ()
        self._looks = 0
        self._listener: Subscription | None = None

    def settle(self) -> None:
        """Before anything is published: leave the clock to whoever has it."""
        others = other_publishers(self._node, CLOCK)
        if not others:
            return
        heard = first_message(self._node, Clock, CLOCK, CLOCK_QOS, LISTENING)
        own = self._node.get_fully_qualified_name()
        self.owned = heard is None and all(own < name for name in others)
        if not self.owned:
            self._say()
        self.look()

    def look(self) -> None:
        """Once a second: listen to others, take the clock if it has ended."""
        others = tuple(other_publishers(self._node, CLOCK))
        if others != self._known:
            self._known, self._looks = others, 0
        self._looks += 1
        self._listen(not self.owned or (bool(others) and self._looks <= LOOKS))
        silent = time.monotonic() - self._heard_at > SILENCE
        if not self.owned and silent and self._now_ns() > self._heard_ns:
            self.owned = True
            self._node.get_logger().info(
                f"{CLOCK}: nobody publishes it any more; this bridge does"
            )

    def _listen(self, wanted: bool) -> None:
        if wanted and self._listener is None:
            self._heard_at = time.monotonic()
            self._listener = self._node.create_subscription(
                Clock, CLOCK, self._on_clock, CLOCK_QOS, raw=True
            )
        elif not wanted and self._listener is not None:
            self._node.destroy_subscription(self._listener)
            self._listener = None

    def _on_clock(self, data: bytes) -> None:
        stamp_ns = read_stamp(data) if len(data) >= STAMP_END else -1
        if self.owned and stamp_ns <= self._now_ns():  # its own, or that of one that is behind
            return
        self._heard_ns, self._heard_at = stamp_ns, time.monotonic()
        if self.owned:
            self.owned = False
            self._say()

    def _say(self) -> None:
        self._node.get_logger().warning(
            f"{CLOCK}: another bridge publishes it on this network; this one leaves it to it"
        )
