"""Parameters of the nodes of this package."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.ros.node_parameters import EXECUTOR, not_negative, parameter, positive
from ghc_mpc_constraints.force_bounds.contact_force_bounds import ForceBoundSettings
from ghc_mpc_constraints.obstacle_motion.approach import ReactionTime
from ghc_mpc_constraints.obstacle_motion.obstacle_bounds import ObstacleSettings
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundWeights

STEP = parameter(0.01, "[s] T between ticks; a multiple of the control period", positive)
HORIZON = parameter(1.5, "[s] N T of the preview; a multiple of the step", positive)
SMOOTHING = parameter(True, "false: raw values pass through, for comparison")
LOCKSTEP = parameter(False, "refuse what would make a run depend on when it arrived")


@dataclass(frozen=True, slots=True)
class ForceBoundParameters:
    """Parameters of contact_force_bounds."""

    step: float = STEP
    horizon: float = HORIZON
    upper_rate_weight: float = parameter(
        0.1, "[s^2] alpha of eq. 5.8: weight of the upper bound's rate; 0.05 to 0.8", positive
    )
    lower_rate_weight: float = parameter(
        0.1, "[s^2] beta of eq. 5.8: weight of the lower bound's rate; 0.05 to 0.8", positive
    )
    tighten_rate: float = parameter(
        50.0, "[N/s] towards the tightest bound ahead, without solution and plan", positive
    )
    contacts: tuple[str, ...] = parameter((), "names that schedules may use; none = any")
    smoothing: bool = SMOOTHING
    lockstep: bool = LOCKSTEP
    take_over_timeout: float = parameter(
        0.5,
        "[s] wall: wait for the bounds in force and their schedules before the first plan",
        not_negative,
    )
    executor: str = EXECUTOR

    def settings(self) -> ForceBoundSettings:
        """Settings of the generator; GhcError for a value out of range."""
        return ForceBoundSettings(
            step=self.step,
            horizon=self.horizon,
            weights=ForceBoundWeights(self.upper_rate_weight, self.lower_rate_weight),
            tighten_rate=self.tighten_rate,
            smoothing=self.smoothing,
        )


@dataclass(frozen=True, slots=True)
class ObstacleParameters:
    """Parameters of obstacle_bounds."""

    step: float = STEP
    horizon: float = HORIZON
    jerk_weight: float = parameter(1e-5, "[s^6] gamma of eq. 4.14; 1e-8 to 1e-4", positive)
    dynamic_weighting: bool = parameter(
        True, "weighting matrix D of eq. 4.15, against overshoot; false: constant weight"
    )
    power: float = parameter(7.0, "[-] g of eq. 4.16; the lowest weight is 10^-g", not_negative)
    max_velocity: float = parameter(
        0.1, "[m/s] v_max of eq. 4.4: how fast the robot can make room", positive
    )
    reaction_time: float = parameter(
        0.3,
        "[s] at least, for however small an approach; eq. 4.4 is for larger ones",
        positive,
    )
    margin: float = parameter(
        0.05, "[m] beyond the safe distance, where virtual obstacles enter and leave", not_negative
    )
    sensor_period: float = parameter(
        0.0,
        "[s] of the robot's time: ticks at its multiples wait for the obstacles of their stamp; "
        "0 = never",
        not_negative,
    )
    stale_after: float = parameter(
        0.5, "[s] without a message: obstacles are taken to be closer", positive
    )
    stale_margin: float = parameter(0.05, "[m] by which they are taken to be closer", not_negative)
    smoothing: bool = SMOOTHING
    take_over_timeout: float = parameter(
        0.5, "[s] wall: wait for the motion in force before the first plan", not_negative
    )
    executor: str = EXECUTOR

    def settings(self) -> ObstacleSettings:
        """Settings of the generator; GhcError for a value out of range."""
        return ObstacleSettings(
            step=self.step,
            horizon=self.horizon,
            jerk_weight=self.jerk_weight,
            dynamic_weighting=self.dynamic_weighting,
            power=self.power,
            reaction=ReactionTime(self.max_velocity, self.reaction_time),
            margin=self.margin,
            stale_after=self.stale_after,
            stale_margin=self.stale_margin,
            smoothing=self.smoothing,
        )
