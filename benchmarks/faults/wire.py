"""The monitor's recording, and the measures by which a fault is evaluated."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ghc_controller.types import NANOSECONDS, Array

SILENCE = 0.1  # [s] without a command, after which the robot has to be held
AT_COMMAND = 1e-9  # [Nm] from a command: it is what is applied
RECENT = 10  # [-] commands that may still be on their way
RAMPED = 0.999  # [-] of the largest change in a period: the rate limit is at work


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
        """Count of numbers in states and commands that are not finite."""
        return sum(
            int((~np.isfinite(values)).sum())
            for values in (self.velocity, self.effort, self.command_effort)
        )

    def longest_silence(self) -> float:
        """Longest time [s] of the robot's clock between two commands."""
        return float(np.diff(self.command_stamp).max(initial=0.0))

    def hold_after(self, ramp: float) -> float:
        """From the last command before the longest silence to the first state under a hold [s].

        The last command stays active for a while, ramped where the rate limit asks for it, and
        those before it may still be on their way: a hold begins when the torque moves away from
        the last one, or is that of no command of the last moments and no part of a ramp. 0
        without a silence, inf where there was no hold until the next command.

        Args:
            ramp: [Nm] change in a period of a torque that the rate limit holds back.
        """
        if self.longest_silence() < SILENCE:
            return 0.0
        last = int(np.argmax(np.diff(self.command_stamp)))
        begin, end = self.command_stamp[last : last + 2]
        recent = self.command_effort[max(last - RECENT, 0) : last + 1]
        before = np.inf
        for k in np.flatnonzero((self.stamp > begin) & (self.stamp < end)):
            away = np.abs(self.effort[k] - recent).max(axis=1)
            ramped = k == 0 or np.abs(self.effort[k] - self.effort[k - 1]).max() > RAMPED * ramp
            other = away.min() > AT_COMMAND and not ramped
            if away[-1] > AT_COMMAND and (away[-1] >= before or other):
                return float(self.stamp[k] - begin)
            before = float(away[-1])
        return float("inf")

    def largest_rate(self, control_dt: float) -> float:
        """Largest change of an applied torque per time [Nm/s] between states of one run.

        States that the monitor missed are allowed for: the change is over all periods between.
        """
        return _largest_rate(self.stamp, self.effort, control_dt)

    def largest_command_rate(self, control_dt: float) -> float:
        """The same for commands, over consecutively answered states."""
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
