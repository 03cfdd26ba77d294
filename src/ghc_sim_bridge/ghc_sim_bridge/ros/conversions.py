"""Between ROS messages and the bridge's values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ghc_msgs.msg import ObstacleState, ObstacleStateArray
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message

from ghc_controller.ros.time import time_from_nanoseconds
from ghc_controller.types import Array
from ghc_sim_bridge.simulation.obstacle_sensor import ObstacleReading


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
