"""Generator of joint position limits: schedules of where joints may be in, moving limits out.

A limit that steps throws a joint back that stands in its way. Each limit moves instead as a chain
of three integrators under a weight on its jerk (thesis, eq. 4.11 to 4.16): the joint can follow it
with an acceleration that does not jump. It reaches the raw limit before that holds, and leaves it
after.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.previews.motion import integrate, state_at
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

_SAME_PLACE = 1e-6  # [rad] what a solve may miss a raw limit by
# Columns of a state (3, 3) with rows position, velocity, acceleration: the upper limit, and the
# lower one with its sign changed, so that both must not be above their raw limit.
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
        """Make the constant matrices and compile.

        Raises:
            InvalidValue: a horizon that is no multiple of the step.
        """
        super().__init__(settings)
        self._qp = MotionQp(self.horizon, settings.jerk_weight)
        self._motions: dict[str, _Motion] = {}
        ramp = np.linspace(1.0, 0.0, self.horizon.steps)
        self._qp.solve(np.ones(3), ramp, np.ones_like(ramp), ramp)
        integrate(np.zeros((3, 3)), np.zeros((2, 3)), settings.step)
        state_at(np.zeros((3, 3)), np.zeros((2, 3)), settings.step, 0.0)

    @property
    def second_opinions(self) -> int:
        """How often the structured solve had to be repeated by another solver."""
        return self._qp.second.asked

    def reset(self) -> None:
        """Forget schedules, previews, motions and limits in force: time starts again."""
        super().reset()
        self._motions.clear()

    def smooth(
        self, name: str, time: float, first: tuple[float, float], raw: RawBounds
    ) -> tuple[Array, Array] | None:
        """Limits (N,), (N,) [rad] of least jerk; None where they would cross."""
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
        places = integrate(state, jerk, self.horizon.step)[1:, 0]
        upper = np.minimum(places[:, _UPPER], raw.upper[1:])
        lower = np.maximum(-places[:, _LOWER], raw.lower[1:])
        if (lower > upper).any():
            self._motions.pop(name, None)
            return None
        self._motions[name] = _Motion(time, state, jerk)
        return lower, upper

    def _state(self, name: str, time: float, first: tuple[float, float]) -> Array:
        """Where the motion before has come to; at rest on the bounds in force without one."""
        state = np.zeros((3, 3))
        before = self._motions.get(name)
        if before is not None:
            elapsed = max(time - before.start, 0.0)
            state = state_at(before.state, before.jerk, self.horizon.step, elapsed)
        for column, place in ((_UPPER, first[1]), (_LOWER, -first[0])):
            if before is None or abs(state[0, column] - place) > _SAME_PLACE:
                state[:, column] = (place, 0.0, 0.0)
            state[0, column] = place
        return state
