"""Transforms of /tf and /tf_static."""

from __future__ import annotations

from collections.abc import Iterable

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from tf2_msgs.msg import TFMessage

from ghc_controller.types import Array
from ghc_sim_bridge.display.link_tree import Transform

# As tf2's own broadcasters.
TF_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
STATIC_TF_QOS = QoSProfile(
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class TransformNames:
    """Names of links on /tf: with a prefix, and the world without one."""

    def __init__(self, prefix: str, world: str) -> None:
        self._prefix, self.world = prefix, world

    def message(self, transforms: Iterable[Transform], stamp: Time) -> TFMessage:
        """Links in their parents at a time."""
        return TFMessage(
            transforms=[
                stamped(
                    self.of(entry.parent),
                    self.of(entry.child),
                    entry.translation,
                    entry.quaternion,
                    stamp,
                )
                for entry in transforms
            ]
        )

    def of(self, link: str) -> str:
        """Name of a link; a link that is called as the world is the world."""
        return link if link == self.world else f"{self._prefix}{link}"


def stamped(
    parent: str, child: str, translation: Array, quaternion: Array, stamp: Time
) -> TransformStamped:
    """One transform: translation (3,) [m], quaternion (4,) x, y, z, w."""
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, stamp
    place, turn = message.transform.translation, message.transform.rotation
    place.x, place.y, place.z = map(float, translation)
    turn.x, turn.y, turn.z, turn.w = map(float, quaternion)
    return message
