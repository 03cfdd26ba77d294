"""What all conversions share: numbers and diagnostics."""

from __future__ import annotations

from array import array
from collections.abc import Mapping

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from ghc_controller.ros.time import time_from_nanoseconds
from ghc_controller.types import Array


def doubles(values: Array) -> array[float]:
    """Entries in row-major order, as a message takes them without a look at each."""
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
