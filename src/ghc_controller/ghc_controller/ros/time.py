"""Conversions between message stamps, nanoseconds and seconds."""

from __future__ import annotations

from builtin_interfaces.msg import Time

from ghc_controller.types import NANOSECONDS


def time_from_nanoseconds(stamp_ns: int) -> Time:
    """Stamp [ns] as a message."""
    seconds, nanoseconds = divmod(stamp_ns, NANOSECONDS)
    return Time(sec=seconds, nanosec=nanoseconds)


def nanoseconds_from_time(stamp: Time) -> int:
    """Stamp of a message in [ns]."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def time_from_seconds(seconds: float) -> Time:
    """Time [s] as a message, to the nearest nanosecond."""
    return time_from_nanoseconds(round(seconds * NANOSECONDS))


def seconds_from_time(stamp: Time) -> float:
    """Stamp of a message in [s]."""
    return nanoseconds_from_time(stamp) / NANOSECONDS
