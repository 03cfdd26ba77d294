"""Parameters of the nodes of this package."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.schema.declared import inline
from ghc_controller.schema.parameters import EXECUTOR, not_negative, parameter
from ghc_mpc_constraints.force_bounds.contact_force_bounds import ForceBoundSettings
from ghc_mpc_constraints.obstacle_motion.obstacle_bounds import ObstacleSettings

TAKE_OVER = parameter(
    0.5, "[s] wall: wait for what is in force, and schedules, before the first plan", not_negative
)


@dataclass(frozen=True, slots=True)
class ForceBoundParameters:
    """Parameters of contact_force_bounds: those of its settings, and what only the node needs."""

    settings: ForceBoundSettings = inline(ForceBoundSettings)
    contacts: tuple[str, ...] = parameter((), "names that schedules may use; none = any")
    lockstep: bool = parameter(False, "refuse what would make a run depend on when it arrived")
    take_over_timeout: float = TAKE_OVER
    executor: str = EXECUTOR


@dataclass(frozen=True, slots=True)
class ObstacleParameters:
    """Parameters of obstacle_bounds: those of its settings, and what only the node needs."""

    settings: ObstacleSettings = inline(ObstacleSettings)
    sensor_period: float = parameter(
        0.0,
        "[s] of the robot's time: ticks at its multiples wait for the obstacles of their stamp; "
        "0 = never",
        not_negative,
    )
    take_over_timeout: float = TAKE_OVER
    executor: str = EXECUTOR
