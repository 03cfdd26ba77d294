"""What the monitor recorded, and the figures by which a fault is judged."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ghc_controller.types import NANOSECONDS, Array


@dataclass(frozen=True, slots=True)
class Wire:
    """Joint states in order of arrival; s states of n joints."""

    wall: Array  # (s,) [s] monotonic
    stamp: Array  # (s,) [s]
    velocity: Array  # (s, n) [rad/s]
    effort: Array  # (s, n) [Nm] applied over the last period
    command_stamp: Array  # (c,) [s]
    command_effort: Array  # (c, n) [Nm]

    @classmethod
    def load(cls, path: Path) -> Wire:
        """Read a recording of the monitor."""
        with np.load(path) as columns:
            return cls(
                columns["joint_states_wall"] / NANOSECONDS,
                columns["joint_states_stamp"] / NANOSECONDS,
                columns["joint_states_velocity"],
                columns["joint_states_effort"],
                columns["joint_commands_stamp"] / NANOSECONDS,
                columns["joint_commands_effort"],
            )

    def largest_rate(self, control_dt: float) -> float:
        """Largest change of an applied torque per time [Nm/s] between states of one run.

        States that the monitor missed are allowed for: the change is over all periods between.
        """
        return _largest_rate(self.stamp, self.effort, control_dt)

    def largest_command_rate(self, control_dt: float) -> float:
        """The same of what was commanded, over states that were answered one after the other."""
        return _largest_rate(self.command_stamp, self.command_effort, control_dt)

    def largest_share(self, limit: Array, of: str = "effort") -> float:
        """Largest |value| / limit of `effort`, `velocity` or `command_effort`."""
        values = getattr(self, of)
        return float((np.abs(values) / limit).max(initial=0.0))


def _largest_rate(stamp: Array, effort: Array, control_dt: float) -> float:
    if len(stamp) < 2:
        return 0.0
    steps = np.round(np.diff(stamp) / control_dt)
    change = np.abs(np.diff(effort, axis=0)).max(axis=1)
    forward = steps >= 1
    return float((change[forward] / (steps[forward] * control_dt)).max(initial=0.0))
