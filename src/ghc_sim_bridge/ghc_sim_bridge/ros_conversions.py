"""Between ROS messages and the bridge's values; quality of service of its topics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import ObstacleState, ObstacleStateArray
from nav_msgs.msg import Odometry
from numpy.typing import NDArray
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

from ghc_sim_bridge.obstacle_sensor import ObstacleReading
from ghc_sim_bridge.state_cdr import NANOSECONDS

Array = NDArray[np.float64]

# Reliable on the publisher so that every reader matches; best effort on the control path, where
# a message that is late is worth less than the next one.
CONTROL_PUBLISHER_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=1, reliability=ReliabilityPolicy.RELIABLE
)
# With every message kept until each reliable reader has it, publishing waits for a slow recorder.
LOSSLESS_PUBLISHER_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE
)
CONTROL_SUBSCRIBER_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=1, reliability=ReliabilityPolicy.BEST_EFFORT
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


def time_from_nanoseconds(stamp_ns: int) -> Time:
    """Stamp [ns] as a message."""
    seconds, nanoseconds = divmod(stamp_ns, NANOSECONDS)
    return Time(sec=seconds, nanosec=nanoseconds)


def nanoseconds_from_time(stamp: Time) -> int:
    """Stamp of a message in [ns]."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def read_joint_state(data: bytes) -> JointState:
    """Message of its serialized bytes.

    Raises:
        ValueError: the bytes are no JointState.
    """
    try:
        return deserialize_message(data, JointState)
    except Exception as error:  # the middleware's own type, whatever it is
        raise ValueError(f"not a JointState: {error}") from error


def pose_of(data: bytes) -> Array:
    """Position [m] and quaternion xyzw of a serialized Odometry, (7,)."""
    pose = deserialize_message(data, Odometry).pose.pose
    point, turn = pose.position, pose.orientation
    return np.array([point.x, point.y, point.z, turn.x, turn.y, turn.z, turn.w])


def wrench_from_message(message: WrenchStamped) -> Array:
    """Force [N] and torque [Nm], (6,)."""
    force, torque = message.wrench.force, message.wrench.torque
    return np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])


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


def diagnostics_message(
    stamp_ns: int, node_name: str, summary: str, warning: bool, values: Mapping[str, object]
) -> DiagnosticArray:
    """One status with its values as text."""
    status = DiagnosticStatus(
        level=DiagnosticStatus.WARN if warning else DiagnosticStatus.OK,
        name=node_name,
        message=summary,
        hardware_id="simulation",
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )
    message = DiagnosticArray(status=[status])
    message.header.stamp = time_from_nanoseconds(stamp_ns)
    return message
