"""One clock per network: of several bridges, each with its own robot, one publishes /clock."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from ghc_controller.ros.qos import CLOCK_QOS
from ghc_controller.ros.wire.cdr import STAMP_END, read_stamp
from ghc_sim_bridge.bridge.publisher import Publish
from ghc_sim_bridge.ros.others import CLOCK, other_publishers
from ghc_sim_bridge.run.clock_lock import ClockLock
from ghc_sim_bridge.run.heard_clock import HeardClock

LOOKS = 5  # [-] looks after another publisher has come, while which it is listened to


class SharedClock:
    """Publishes the clock if this bridge owns it, so that it never goes back.

    Bridges of one host agree by a lock, before any of them publishes; the owner keeps the
    clock until its process ends. Another one then takes over when its own time is later. Bridges
    of other hosts can only be heard: the one that is behind leaves the clock to the other, once
    several times in a row are ahead of its own, and takes it back when it has timed out.
    """

    def __init__(self, node: Node, publish: Publish, now_ns: Callable[[], int]) -> None:
        """`publish` sends a serialized clock; `now_ns` gives the bridge's time [ns]."""
        self._node = node
        self._publish = publish
        self._now_ns = now_ns
        self._heard = HeardClock()  # of another host
        self._known: tuple[str, ...] = ()
        self._looks = 0
        self._listener: Subscription | None = None
        try:
            domain = node.context.get_domain_id()
            self._lock: ClockLock | None = ClockLock(domain, node.resolve_topic_name(CLOCK))
        except OSError as error:
            node.get_logger().warning(
                f"{CLOCK} no agreement with other bridges of this host: {error}"
            )
            self._lock = None
        self.owned = self._lock is None or self._lock.take(now_ns())
        if not self.owned:
            self._say("this host")

    def __call__(self, data: bytes) -> None:
        """Publish the serialized time `data`, which is that of the bridge, or leave it."""
        if not self.owned:
            return
        if self._lock is not None:
            self._lock.promise(self._now_ns())
        self._publish(data)

    def look(self) -> None:
        """Once a second: check other publishers, take over the clock if it has timed out."""
        others = tuple(other_publishers(self._node, CLOCK))
        if others != self._known:
            self._known, self._looks = others, 0
        self._looks += 1
        self._listen(self._heard.time_ns >= 0 or (bool(others) and self._looks <= LOOKS))
        if self.owned or not self._heard.leaves_to(self._now_ns()):
            return
        self.owned = self._lock is None or self._lock.take(self._now_ns())
        if self.owned:
            self._heard.forget()
            self._node.get_logger().info(
                f"{CLOCK}: no longer published by another bridge; this bridge takes over"
            )

    def _listen(self, wanted: bool) -> None:
        if wanted and self._listener is None:
            self._listener = self._node.create_subscription(
                Clock, CLOCK, self._on_clock, CLOCK_QOS, raw=True
            )
        elif not wanted and self._listener is not None:
            self._node.destroy_subscription(self._listener)
            self._listener = None

    def _on_clock(self, data: bytes) -> None:
        stamp_ns = read_stamp(data) if len(data) >= STAMP_END else -1
        if self._heard.time_ns < 0 and not self.owned:
            return  # of another bridge of this host
        if self._heard.hear(stamp_ns, self._now_ns()) and self.owned:
            self.owned = False
            self._say("this network")

    def _say(self, where: str) -> None:
        self._node.get_logger().warning(
            f"{CLOCK}: another bridge publishes it on {where}; this bridge does not"
        )
