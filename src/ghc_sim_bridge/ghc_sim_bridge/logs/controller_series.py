"""Controller status over a run as arrays, read from a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.types import NANOSECONDS, Array
from ghc_sim_bridge.recorder.bag_reading import read_messages

SCHEMA = "ghc_msgs/msg/ControllerState"


@dataclass(frozen=True, slots=True)
class ControllerSeries:
    """S samples for k tasks."""

    tasks: tuple[str, ...]
    time: Array  # (S,) [s] simulated
    alpha: Array  # (S, k, k) [-]
    error_norms: Array  # (S, k) [m] or [rad]
    references: Mapping[str, Array]  # task -> (S, m) in force, [m], [rad] or [-]
    errors: Mapping[str, Array]  # task -> (S, rows) reference - actual [m], [rad] or [N]

    @classmethod
    def from_recording(cls, path: Path) -> ControllerSeries:
        """Read the controller status from a bag folder or an MCAP file, also a truncated one.

        Reads the first topic of the type, regardless of its name.

        Raises:
            ConfigurationError: it cannot be read, or contains no status.
        """
        reports = _reports(path)
        if not reports:
            raise ConfigurationError(f"recording '{path}' holds no {SCHEMA}")
        return cls.from_reports(list(reports.values()), np.array(list(reports)) * 1e-9)

    @classmethod
    def from_reports(cls, reports: list[Any], time: Array) -> ControllerSeries:
        """Arrays of ControllerState messages at `time` (S,) [s]; the tasks must not change."""
        tasks = tuple(task.name for task in reports[0].tasks)
        k = len(tasks)
        return cls(
            tasks=tasks,
            time=time,
            alpha=np.array([report.alpha for report in reports], float).reshape(-1, k, k),
            error_norms=np.array([[t.error_norm for t in r.tasks] for r in reports], float),
            references={
                name: np.array([report.tasks[i].reference for report in reports], float)
                for i, name in enumerate(tasks)
            },
            errors={
                name: np.array([report.tasks[i].error for report in reports], float)
                for i, name in enumerate(tasks)
            },
        )


def _reports(path: Path) -> dict[int, Any]:
    """Stamp [ns] -> status; the first one for a state that was answered twice."""
    reports: dict[int, Any] = {}
    first = ""
    for topic, _, report in read_messages(path, SCHEMA):
        first = first or topic
        if topic == first:
            stamp = report.header.stamp
            reports.setdefault(stamp.sec * NANOSECONDS + stamp.nanosec, report)
    return dict(sorted(reports.items()))
