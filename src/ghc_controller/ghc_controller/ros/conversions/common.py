"""What all conversions share: quality of service, stamps, numbers, diagnostics."""

from __future__ import annotations

from array import array
from collections.abc import Mapping

import numpy as np
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ghc_controller.ros.wire.cdr import NANOSECONDS
from ghc_controller.types import Array

# Reliable on the publisher so that every reader matches; best effort on the control path, where
# a message that is late is worth less than the next one.
CONTROL_PUBLISHER_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
CONTROL_SUBSCRIBER_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
RELIABLE_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
LATCHED_QOS = QoSProfile(
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
STREAM_QOS = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


def time_from_nanoseconds(stamp_ns: int) -> Time:
    """Stamp [ns] as a message."""
    seconds, nanoseconds = divmod(stamp_ns, NANOSECONDS)
    return Time(sec=seconds, nanosec=nanoseconds)


def nanoseconds_from_time(stamp: Time) -> int:
    """Stamp of a message in [ns]."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def doubles(values: Array) -> array[float]:
    """Entries in row-major order, as a message takes them without a look at each."""
    return array("d", np.ascontiguousarray(values, dtype=np.float64).tobytes())


def time_from_seconds(seconds: float) -> Time:
    """Time [s] as a message, to the nearest nanosecond."""
    return time_from_nanoseconds(round(seconds * NANOSECONDS))


def diagnostics_message(
    stamp_ns: int,
    node_name: str,
    summary: str,
    warning: bool,
    values: Mapping[str, object],
    hardware_id: str = "",
) -> DiagnosticArray:
    """One status with its values as text."""
    status = DiagnosticStatus(
        level=DiagnosticStatus.WARN if warning else DiagnosticStatus.OK,
        name=node_name,
        message=summary,
        hardware_id=hardware_id,
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )
    message = DiagnosticArray(status=[status])
    message.header.stamp = time_from_nanoseconds(stamp_ns)
    return message
