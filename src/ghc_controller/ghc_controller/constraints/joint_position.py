"""Joint position limits as acceleration bounds that keep the joint able to stop in time."""

from __future__ import annotations

from collections.abc import Sequence

from ghc_controller.constraints.compiled import CompiledBox
from ghc_controller.constraints.constraint import Softness, Space, positive_per_joint
from ghc_controller.core import PositionBox
from ghc_controller.errors import UnknownName
from ghc_controller.previews.limits_in_force import LimitsInForce, MovingLimits
from ghc_controller.previews.preview import JOINT_LIMITS, Preview
from ghc_controller.types import Array


class JointPositionLimit(CompiledBox):
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
    acceleration falls with -j to -a_brake (`core/constraints/joint_bounds.hpp`), and the way back
    is bounded too. Between limits too close for both, the one ahead counts.

    A limit that moves (`limits`, from a preview) with rate w and acceleration a is approached
    softly alone, x <= a + r^2 d - 2 r (v - w) with its distance d: the generator has planned it
    for the joint to follow, and viability at no distance would answer the last digits of d.
    """

    space = Space.ACCELERATION
    softness = Softness.SOFT
    kind = JOINT_LIMITS
    core: PositionBox

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
        self.changes = True
        self.core = PositionBox(self.brake_acceleration, self.approach_rate)
        self._given: MovingLimits | None = None  # to the core

    def follow(self, preview: Preview, now: float | None = None) -> tuple[UnknownName, ...]:
        """See `LimitsInForce.follow`."""
        return self.limits.follow(preview, now)

    def is_stale(self, time: float) -> bool:
        """Whether the preview has ended at `time` [s]."""
        return self.limits.is_stale(time)

    def reset(self) -> None:
        """Forget the preview."""
        self.limits.reset()

    def prepare(self, time: float) -> None:
        """See CompiledBox."""
        limits = self.limits.at(time)
        if limits is not self._given:  # without a preview the same object every tick
            self.core.set_limits(limits.lower, limits.upper, limits.rates, limits.accelerations)
            self._given = limits
