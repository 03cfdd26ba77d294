"""What the controller reported over a run, as arrays, read back from a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from ghc_controller.errors import ConfigurationError
from ghc_controller.types import NANOSECONDS, Array

SCHEMA = "ghc_msgs/msg/ControllerState"


@dataclass(frozen=True, slots=True)
class ControllerSeries:
    """S reports of k tasks."""

    tasks: tuple[str, ...]
    time: Array  # (S,) [s] simulated
    alpha: Array  # (S, k, k) [-]
    error_norms: Array  # (S, k) [m] or [rad]
    references: Mapping[str, Array]  # task -> (S, m) in force, [m], [rad] or [-]
    errors: Mapping[str, Array]  # task -> (S, rows) reference - actual [m], [rad] or [N]

    @classmethod
    def from_mcap(cls, path: Path) -> ControllerSeries:
        """Read the controller's reports of a recording, whatever the name of their topic.

        Raises:
            ConfigurationError: the file cannot be read, or holds no report.
        """
        try:
            with path.open("rb") as file:
                reports = _reports(make_reader(file, decoder_factories=[DecoderFactory()]))
        except (OSError, McapError) as error:
            raise ConfigurationError(f"recording '{path}': {error}") from error
        if not reports:
            raise ConfigurationError(f"recording '{path}' holds no {SCHEMA}")
        return cls.from_reports(list(reports.values()), np.array(list(reports)) * 1e-9)

    @classmethod
    def from_reports(cls, reports: list[Any], time: Array) -> ControllerSeries:
        """Arrays of ControllerState messages at `time` (S,) [s], all with the same tasks."""
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


def _reports(reader: Any) -> dict[int, Any]:
    """Stamp [ns] -> report; of a state that was answered twice, the first one."""
    summary = reader.get_summary()
    names = {schema.id for schema in summary.schemas.values() if schema.name == SCHEMA}
    topics = [c.topic for c in summary.channels.values() if c.schema_id in names]
    reports: dict[int, Any] = {}
    if not topics:
        return reports
    for _, _, _, report in reader.iter_decoded_messages(topics=topics[:1]):
        stamp = report.header.stamp
        reports.setdefault(stamp.sec * NANOSECONDS + stamp.nanosec, report)
    return dict(sorted(reports.items()))
