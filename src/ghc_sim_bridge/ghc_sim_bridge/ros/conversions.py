"""Between ROS messages and the bridge's values; quality of service of its topics."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ghc_msgs.msg import ObstacleState, ObstacleStateArray
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from ghc_controller.ros.conversions.common import time_from_nanoseconds
from ghc_controller.types import Array
from ghc_sim_bridge.simulation.obstacle_sensor import ObstacleReading

# With every message kept until each reliable reader has it, publishing waits for a slow recorder.
LOSSLESS_PUBLISHER_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE
)
CLOCK_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
)


# Deep enough for whatever a node says at once; slow topics hold few messages anyway.
RECORDING_DEPTH = 1000  # [-]


def recording_qos(offered: Sequence[QoSProfile], lossless: bool) -> QoSProfile:
    """Quality of service that matches every one of the `offered` ones.

    Latched messages are asked for only where all publishers keep them; reliability likewise, and
    only if `lossless`: acknowledging each message of a fast topic costs its publisher time.
    """
    reliable = all(o.reliability == ReliabilityPolicy.RELIABLE for o in offered)
    latched = all(o.durability == DurabilityPolicy.TRANSIENT_LOCAL for o in offered)
    best_effort = not (lossless and reliable)
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST if best_effort else HistoryPolicy.KEEP_ALL,
        depth=RECORDING_DEPTH,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def pose_of(data: bytes) -> Array:
    """Position [m] and quaternion xyzw of a serialized Odometry, (7,)."""
    pose = deserialize_message(data, Odometry).pose.pose
    point, turn = pose.position, pose.orientation
    return np.array([point.x, point.y, point.z, turn.x, turn.y, turn.z, turn.w])


def obstacles_message(
    stamp_ns: int, frame: str, readings: Sequence[ObstacleReading]
) -> ObstacleStateArray:
    """What the obstacle sensor has at `stamp_ns` [ns], in axes of `frame`; raw fields only."""
    message = ObstacleStateArray()
    message.header.stamp = time_from_nanoseconds(stamp_ns)
    message.header.frame_id = frame
    for reading in readings:
        entry = ObstacleState(id=reading.id, protected_frame=reading.protected_frame)
        entry.position[:], entry.normal[:] = reading.position, reading.normal
        entry.distance, entry.safe_distance = reading.distance, reading.safe_distance
        message.obstacles.append(entry)
    return message
