"""Quality of service of every topic."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

# Publishers are reliable so that every reader matches. Readers on the control path are best
# effort: the next message is more useful than a late one.
CONTROL_PUBLISHER_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
CONTROL_SUBSCRIBER_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
RELIABLE_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
LATCHED_QOS = QoSProfile(
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
STREAM_QOS = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
# As STREAM_QOS, for a reader that needs every message but reads rarely.
TRACE_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
PREVIEW_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
# All generators publish on one topic: readers keep a preview of each.
PREVIEW_SUBSCRIBER_QOS = QoSProfile(depth=20, reliability=ReliabilityPolicy.RELIABLE)
# One message per contact, kept for generators that start later.
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


# Deep enough for any burst of a node; slow topics hold few messages anyway.
RECORDING_DEPTH = 1000  # [-]


def recording_qos(offered: Sequence[QoSProfile], lossless: bool) -> QoSProfile:
    """Quality of service compatible with all `offered` ones.

    Latched messages are requested only if all publishers latch them. Reliability is requested
    only if all offer it and `lossless` is set: acknowledgments of a fast topic cost its publisher
    time.
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
