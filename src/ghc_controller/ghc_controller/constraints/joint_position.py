"""Joint position limits as acceleration bounds that keep the joint able to stop in time."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numba

from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Softness,
    Space,
    Tick,
    positive_per_joint,
)
from ghc_controller.constraints.jerk_kernels import position_bound
from ghc_controller.errors import UnknownName
from ghc_controller.previews.limits_in_force import LimitsInForce
from ghc_controller.previews.preview import JOINT_LIMITS, Preview
from ghc_controller.types import Array


class JointPositionLimit(BoxConstraint):
    """Viability: |v| <= sqrt(2 a_brake (q_max - q)) one control period from now.

    A joint that satisfies it stops before its limit by braking with a_brake [rad/s^2], which is
    stated here because the torque box must be able to deliver it. The upper bound is the largest
    constant acceleration over dt after which

        (v + x dt)^2 / (2 a_brake) <= q_max - q - v dt - x dt^2 / 2      when v + x dt > 0,

    a quadratic inequality in x; the lower bound mirrors it. For x > 0 the last term is taken as
    x dt^2, so that a semi-implicit integrator (MuJoCo's) does not overtake the bound either. The
    box always contains clip(-v / dt, -a_brake, a_brake), braking to a stop: it is never empty,
    and a joint that is already beyond a limit may stop or return, as fast as it likes, but not
    go on. With a planned jerk j (`Tick.jerk`) the box is narrower: from the next period on the
    acceleration falls with -j to -a_brake (`jerk_kernels`), and the way back is bounded too.
    Between limits too close for both, the one ahead counts.

    A limit that moves (`limits`, from a preview) with rate w and acceleration a is approached
    softly alone, x <= a + r^2 d - 2 r (v - w) with its distance d: the generator has planned it
    for the joint to follow, and viability at no distance would answer the last digits of d.
    """

    space = Space.ACCELERATION
    softness = Softness.SOFT
    kind = JOINT_LIMITS

    def __init__(
        self,
        lower: Array,
        upper: Array,
        brake_acceleration: Array | float = 5.0,
        name: str = "position_limit",
        approach_rate: float = 8.0,
        joints: Sequence[str] = (),
    ) -> None:
        """Bound the last a entries of q by lower and upper (a,) [rad]; approach_rate r [1/s].

        +-inf stands for no limit; `joints` names the entries for previews to follow.
        """
        super().__init__(name)
        self.approach_rate = float(positive_per_joint(approach_rate, 1, f"{name}, rate")[0])
        self.lower, self.upper = lower.copy(), upper.copy()
        count = lower.shape[0]
        self.brake_acceleration = positive_per_joint(
            brake_acceleration, count, f"{name}, brake acceleration"
        )
        names = tuple(joints) or tuple(f"joint_{i + 1}" for i in range(count))
        self.limits = LimitsInForce(JOINT_LIMITS, names, lower, upper)

    def follow(self, preview: Preview, now: float | None = None) -> tuple[UnknownName, ...]:
        """See `LimitsInForce.follow`."""
        return self.limits.follow(preview, now)

    def is_stale(self, time: float) -> bool:
        """Whether the preview has ended at `time` [s]."""
        return self.limits.is_stale(time)

    def reset(self) -> None:
        """Forget the preview."""
        self.limits.reset()

    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """Write the acceleration box of this state."""
        limits = self.limits.at(tick.state.time)
        _position_box(
            tick.model.q,
            tick.model.v,
            limits.lower,
            limits.upper,
            limits.rates,
            limits.accelerations,
            self.brake_acceleration,
            self.approach_rate,
            tick.dt,
            lower,
            upper,
        )
        if tick.jerk is not None:
            _narrow(
                tick.model.q,
                tick.model.v,
                limits.lower,
                limits.upper,
                limits.rates,
                limits.accelerations,
                self.brake_acceleration,
                tick.jerk,
                tick.dt,
                lower,
                upper,
            )


@numba.njit(cache=True)
def viable_acceleration(distance: float, v: float, brake: float, dt: float) -> float:
    """Largest acceleration towards a limit that is `distance` away, approached with speed v."""
    if distance == math.inf:
        return math.inf
    stop = -v / dt
    # (v + x dt)^2 / (2 brake) + v dt + c x dt^2 - distance = a x^2 + b x + constant
    a = dt * dt / (2.0 * brake)
    constant = v * v / (2.0 * brake) + v * dt - distance
    best = -math.inf
    for c in (1.0, 0.5):
        b = v * dt / brake + c * dt * dt
        discriminant = b * b - 4.0 * a * constant
        if discriminant >= 0.0:
            best = (-b + math.sqrt(discriminant)) / (2.0 * a)
            if best >= 0.0:
                break
    if best < stop:  # it cannot only slow down: it must turn back, or stay inside while stopping
        best = min(stop, 2.0 * (distance - v * dt) / (dt * dt))
    return max(best, stop, -brake)


@numba.njit(cache=True)
def soft_approach(distance: float, v: float, brake: float, rate: float, dt: float) -> float:
    """Acceleration of a critically damped approach to a limit; never forbids braking."""
    approach = rate * rate * distance - 2.0 * rate * v
    return max(approach, min(max(-v / dt, -brake), brake))


@numba.njit(cache=True)
def moving_approach(
    distance: float, v: float, w: float, a: float, brake: float, rate: float, dt: float
) -> float:
    """As `soft_approach`, of a limit that moves with rate w and acceleration a.

    Braking is never forbidden: to a stop, or where the limit comes closer, to its rate.
    """
    relative = v - w
    approach = a + rate * rate * distance - 2.0 * rate * relative
    stop = min(max(-v / dt, -brake), brake)
    follow = a + min(max(-relative / dt, -brake), brake)
    return max(approach, min(stop, follow))


@numba.njit(cache=True)
def _position_box(
    q: Array,
    v: Array,
    q_min: Array,
    q_max: Array,
    rates: Array,
    accelerations: Array,
    brake: Array,
    rate: float,
    dt: float,
    lower: Array,
    upper: Array,
) -> None:
    q_base, v_base = q.shape[0] - brake.shape[0], v.shape[0] - brake.shape[0]
    for i in range(brake.shape[0]):
        position, speed = q[q_base + i], v[v_base + i]
        to_upper, to_lower = q_max[i] - position, position - q_min[i]
        k, w_max, w_min = v_base + i, rates[1, i], rates[0, i]
        a_min, a_max = accelerations[0, i], accelerations[1, i]
        upper[k] = moving_approach(to_upper, speed, w_max, a_max, brake[i], rate, dt)
        if w_max == 0.0 and a_max == 0.0:
            upper[k] = min(upper[k], viable_acceleration(to_upper, speed, brake[i], dt))
        lower[k] = -moving_approach(to_lower, -speed, -w_min, -a_min, brake[i], rate, dt)
        if w_min == 0.0 and a_min == 0.0:
            lower[k] = max(lower[k], -viable_acceleration(to_lower, -speed, brake[i], dt))
        if lower[k] > upper[k]:  # only between limits that move
            lower[k] = upper[k] = 0.5 * (lower[k] + upper[k])


@numba.njit(cache=True)
def _narrow(
    q: Array,
    v: Array,
    q_min: Array,
    q_max: Array,
    rates: Array,
    accelerations: Array,
    brake: Array,
    jerk: Array,
    dt: float,
    lower: Array,
    upper: Array,
) -> None:
    """Narrow a box, never to none, to accelerations after which a joint can stop with its jerk."""
    q_base, v_base = q.shape[0] - brake.shape[0], v.shape[0] - brake.shape[0]
    for i in range(brake.shape[0]):
        p, s, k = q[q_base + i], v[v_base + i], v_base + i
        if rates[1, i] == 0.0 and accelerations[1, i] == 0.0:
            upper[k] = position_bound(q_max[i] - p, s, jerk[i], brake[i], dt, upper[k])
        if rates[0, i] == 0.0 and accelerations[0, i] == 0.0:
            lower[k] = -position_bound(p - q_min[i], -s, jerk[i], brake[i], dt, -lower[k])
        if lower[k] > upper[k] and s > 0.0:
            lower[k] = upper[k]
        elif lower[k] > upper[k]:
            upper[k] = lower[k]
