"""Generator of joint position limits: continuous limits from schedules at each tick.

A limit that steps past a joint position causes a jump of its acceleration. Instead, each limit
moves as a triple integrator with a weight on its jerk (thesis, eq. 4.11 to 4.16), and the joint
follows it with continuous acceleration. It reaches a tighter raw limit before that applies, and
leaves it afterwards.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.core import native
from ghc_controller.previews.preview import JOINT_LIMITS
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import NOT_NEGATIVE, POSITIVE
from ghc_controller.types import Array
from ghc_mpc_constraints.bounds_generator import BoundsGenerator
from ghc_mpc_constraints.generator import Schedules, register_generator
from ghc_mpc_constraints.previews.horizon import HORIZON, SMOOTHING, STEP
from ghc_mpc_constraints.previews.motion_qp import MotionQp
from ghc_mpc_constraints.previews.motion_weights import POWER, dynamic_weights
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule
from ghc_mpc_constraints.schedules.raw_bounds import RawBounds

_SAME_PLACE = 1e-6  # [rad] tolerance of a solve at a raw limit
# Columns of a state (3, 3) with rows position, velocity, acceleration: the upper limit and the
# negated lower limit, so that both are bounded above by their raw limit.
_UPPER, _LOWER = 0, 1


@dataclass(frozen=True, slots=True)
class JointLimitSettings:
    """Settings of the generator.

    Raises:
        InvalidValue: a number outside its range.
    """

    step: float = STEP
    horizon: float = HORIZON
    jerk_weight: float = declared(
        "gamma of eq. 4.14; 1e-6 to 1e-3", 1e-4, unit="s^6", domain=POSITIVE
    )
    power: float = declared(
        "g of eq. 4.16, against overshoot; the lowest weight is 10^-g; 0 = constant weight",
        POWER,
        unit="-",
        domain=NOT_NEGATIVE,
    )
    tighten_rate: float = declared(
        "towards the tightest limit ahead, without solution and preview",
        0.2,
        unit="rad/s",
        domain=POSITIVE,
    )
    smoothing: bool = SMOOTHING

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, slots=True)
class _Motion:
    """Both limits of one joint: a state at a tick and the jerks after it."""

    start: float  # [s]
    state: Array  # (3, 3)
    jerk: Array  # (N, 3) [rad/s^3]


@register_generator("joint_limits")
class JointLimits(BoundsGenerator):
    """Both position limits of every scheduled joint over a receding horizon."""

    kind = JOINT_LIMITS
    settings_type = JointLimitSettings
    input = Schedules(
        "constraints/joint_limit_schedule", "ghc_msgs/LimitSchedule", LimitSchedule.read
    )

    def __init__(self, settings: JointLimitSettings) -> None:
        """Compute the constant matrices.

        Raises:
            InvalidValue: the horizon is not a multiple of the step.
        """
        super().__init__(settings)
        self._qp = MotionQp(self.horizon, settings.jerk_weight)
        self._motions: dict[str, _Motion] = {}

    @property
    def second_opinions(self) -> int:
        """How often the structured solve had to be repeated by another solver."""
        return self._qp.second.asked

    def reset(self) -> None:
        """Discard schedules, previews, motions and current limits: time restarts."""
        super().reset()
        self._motions.clear()

    def smooth(
        self, name: str, time: float, first: tuple[float, float], raw: RawBounds
    ) -> tuple[Array, Array] | None:
        """Limits (N,), (N,) [rad] with minimum jerk; None if they would cross."""
        state = self._state(name, time, first)
        jerk = np.zeros((self.horizon.steps, 3))
        for column, limit in ((_UPPER, raw.upper[1:]), (_LOWER, -raw.lower[1:])):
            answer = self._qp.solve(
                state[:, column].copy(), limit, dynamic_weights(limit, self.settings.power), limit
            )
            if answer is None:
                self._motions.pop(name, None)
                return None
            jerk[:, column] = answer
        places = native.integrate(state, jerk, self.horizon.step)[1:, 0]
        upper = np.minimum(places[:, _UPPER], raw.upper[1:])
        lower = np.maximum(-places[:, _LOWER], raw.lower[1:])
        if (lower > upper).any():
            self._motions.pop(name, None)
            return None
        self._motions[name] = _Motion(time, state, jerk)
        return lower, upper

    def _state(self, name: str, time: float, first: tuple[float, float]) -> Array:
        """State of the previous motion; without one, at rest on the current bounds."""
        state = np.zeros((3, 3))
        before = self._motions.get(name)
        if before is not None:
            elapsed = max(time - before.start, 0.0)
            state = native.state_at(before.state, before.jerk, self.horizon.step, elapsed)
        for column, place in ((_UPPER, first[1]), (_LOWER, -first[0])):
            if before is None or abs(state[0, column] - place) > _SAME_PLACE:
                state[:, column] = (place, 0.0, 0.0)
            state[0, column] = place
        return state
