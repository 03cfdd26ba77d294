"""Shared by all conversions: numbers and diagnostics."""

from __future__ import annotations

from array import array
from collections.abc import Mapping

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from ghc_controller.errors import InvalidValue
from ghc_controller.ros.time import time_from_nanoseconds
from ghc_controller.types import Array


def doubles(values: Array) -> array[float]:
    """Entries in row-major order, in a type that messages accept without checking each entry."""
    return array("d", np.ascontiguousarray(values, dtype=np.float64).tobytes())


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


def check_frame(frame_id: str, world_frame: str) -> None:
    """Raises InvalidValue for targets in another frame than the world's."""
    if frame_id not in ("", world_frame):
        raise InvalidValue(
            f"frame_id '{frame_id}' given, '{world_frame}' or an empty one expected: targets are "
            "in the axes of the world"
        )
