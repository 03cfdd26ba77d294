"""What the monitor recorded, and the figures by which a fault is judged."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ghc_controller.types import NANOSECONDS, Array

SILENCE = 0.1  # [s] without a command, after which the robot has to be held
AT_COMMAND = 1e-9  # [Nm] from the last command: it is what is applied


@dataclass(frozen=True, slots=True)
class Wire:
    """Joint states in order of arrival; s states of n joints."""

    wall: Array  # (s,) [s] monotonic
    stamp: Array  # (s,) [s]
    velocity: Array  # (s, n) [rad/s]
    effort: Array  # (s, n) [Nm] applied over the last period
    command_wall: Array  # (c,) [s] monotonic
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
                columns["joint_commands_wall"] / NANOSECONDS,
                columns["joint_commands_stamp"] / NANOSECONDS,
                columns["joint_commands_effort"],
            )

    def between(self, begin: float, end: float) -> Wire:
        """The part that arrived between two times [s]."""
        states = (self.wall >= begin) & (self.wall <= end)
        sent = (self.command_wall >= begin) & (self.command_wall <= end)
        return Wire(
            self.wall[states],
            self.stamp[states],
            self.velocity[states],
            self.effort[states],
            self.command_wall[sent],
            self.command_stamp[sent],
            self.command_effort[sent],
        )

    def not_finite(self) -> int:
        """Numbers of states and commands that are not finite."""
        return sum(
            int((~np.isfinite(values)).sum())
            for values in (self.velocity, self.effort, self.command_effort)
        )

    def longest_silence(self) -> float:
        """Longest time [s] of the robot's clock between two commands."""
        return float(np.diff(self.command_stamp).max(initial=0.0))

    def hold_after(self) -> float:
        """From the last command before the longest silence to the first state under a hold [s].

        The last command stays in force for a while, ramped where the rate limit asks for it: a
        hold begins when the torque is neither there nor on the way to it. 0 without a silence,
        inf where there was no hold until the next command.
        """
        if self.longest_silence() < SILENCE:
            return 0.0
        last = int(np.argmax(np.diff(self.command_stamp)))
        begin, end = self.command_stamp[last : last + 2]
        before = np.inf
        for k in np.flatnonzero((self.stamp > begin) & (self.stamp < end)):
            away = float(np.abs(self.effort[k] - self.command_effort[last]).max())
            if away > AT_COMMAND and away >= before:
                return float(self.stamp[k] - begin)
            before = away
        return float("inf")

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
