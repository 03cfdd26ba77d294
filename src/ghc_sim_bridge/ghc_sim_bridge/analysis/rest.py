"""Whether a robot has come to rest by the end of each phase.

Task errors can be constant while the robot still moves in directions that no task sees.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ghc_controller.types import Array
from ghc_sim_bridge.logs.full_rate_log import FullRateLog

REST_SPEED = 1e-3  # [rad/s], [m/s] of a base's position: what moves more is not at rest
_WINDOW = 3.0  # [s] at the end of a phase, at most half of its hold
_TOLERANCE = 1e-9  # [s] of times


@dataclass(frozen=True, slots=True)
class PhaseRest:
    """Motion that is left at the end of one phase."""

    speed: float  # [rad/s] or [m/s] mean |v| of the fastest coordinate over the window
    window: float  # [s]
    references_rest: bool  # whether all references are constant over the window

    @property
    def still_moves(self) -> bool:
        """Whether the robot moves without a reason."""
        return self.references_rest and self.speed > REST_SPEED


def rest_window(hold: float) -> float:
    """Length [s] of the window at the end of a phase that is held for `hold` [s]."""
    return min(_WINDOW, 0.5 * hold)


def moving_coordinates(log: FullRateLog) -> Array:
    """Velocities of the joints, and of the base where it floats, (T, n) or (T, 6 + n)."""
    return log.v if log.base_velocity is None else np.hstack((log.base_velocity, log.v))


def rest_of_phase(
    time: Array,
    velocity: Array,
    references: Sequence[tuple[Array, Array]],
    end: float,
    window: float,
) -> PhaseRest:
    """Motion over [end - window, end).

    Args:
        time: (T,) [s].
        velocity: (T, n) [rad/s] of the joints, and of the base where it floats ([m/s], [rad/s]).
        references: times (S,) [s] and values (S, p) of each task's reference.
        end: end of the phase [s].
        window: [s].
    """
    rows = _inside(time, end, window)
    speed = np.abs(velocity[rows]).mean(axis=0).max(initial=0.0) if rows.any() else 0.0
    rest = all(
        np.ptp(values[inside], axis=0).max(initial=0.0) == 0.0
        for times, values in references
        if (inside := _inside(times, end, window)).any()
    )
    return PhaseRest(float(speed), window, rest)


def rest_summary(phases: Sequence[PhaseRest]) -> dict[str, Any]:
    """Content of summary.json; phases are counted from 1 as in the table."""
    return {
        "mean_speed_rad_per_s": [phase.speed for phase in phases],
        "window_s": [phase.window for phase in phases],
        "references_rest": [phase.references_rest for phase in phases],
        "threshold_rad_per_s": REST_SPEED,
        "moving_phases": [k for k, phase in enumerate(phases, start=1) if phase.still_moves],
    }


def rest_line(summary: Mapping[str, Any]) -> str:
    """One line when the robot still moves at the end of a phase; "" when it does not."""
    rest = summary["rest"]
    moving = rest["moving_phases"]
    if not moving:
        return ""
    windows = dict.fromkeys(f"{rest['window_s'][k - 1]:g}" for k in moving)
    speeds = ", ".join(f"{rest['mean_speed_rad_per_s'][k - 1]:.2g}" for k in moving)
    return (
        f"joints still move at the end of phase{'s' if len(moving) > 1 else ''} "
        f"{', '.join(map(str, moving))}: mean |v| of the fastest one over the last "
        f"{', '.join(windows)} s {speeds} rad/s (more than {rest['threshold_rad_per_s']:g})"
    )


def _inside(time: Array, end: float, window: float) -> NDArray[np.bool_]:
    return (time > end - window - _TOLERANCE) & (time < end - _TOLERANCE)
