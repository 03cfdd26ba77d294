"""Quality of service of every topic."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

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
# As STREAM_QOS, for a reader that wants every message although it looks rarely.
TRACE_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
PREVIEW_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
# Many generators publish on one topic: a reader keeps a preview of each.
PREVIEW_SUBSCRIBER_QOS = QoSProfile(depth=20, reliability=ReliabilityPolicy.RELIABLE)
# One message a contact: as many are kept for a generator that starts later.
SCHEDULE_QOS = QoSProfile(
    depth=100,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
SENSOR_PUBLISHER_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
SENSOR_SUBSCRIBER_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
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
