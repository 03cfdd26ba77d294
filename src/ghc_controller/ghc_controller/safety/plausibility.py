"""Plausibility of a measured state: for this robot, and after the previous state."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.model.limits import JointLimits
from ghc_controller.safety.base_plausibility import base_jump, check_base, check_wrenches
from ghc_controller.types import Array, RobotState

POSITION_MARGIN = 0.5  # [rad] beyond a position limit that a moving joint may be
START_MARGIN = 0.05  # [rad] the same where a controller starts
VELOCITY_FACTOR = 10.0  # [-] of the velocity limit
JUMP = 0.05  # [rad] between what a joint's velocity leads to and where it is
LONGEST_STEP = 0.1  # [s] over which a velocity predicts the position of a joint
CONFIRMATIONS = 3  # [-] consecutive consistent states that confirm a jump


class ImplausibleStart(InvalidValue):
    """A pose in which the controller must not start."""


class StatePlausibility:
    """Checks consecutive states; a rejected state has no effect.

    Pose and twist of a floating base are checked as positions and velocities of joints are. A
    persistent jump of position is reported once (`jumped`) and then accepted: the caller decides
    whether that is a fault.
    """

    def __init__(
        self, joint_names: Sequence[str], limits: JointLimits, weight: float = 0.0
    ) -> None:
        """Limits (a,) of the joints [rad], [rad/s]; weight of the robot [N]."""
        self._names = tuple(joint_names)
        self._weight = weight
        self._lower, self._upper = limits.position_lower, limits.position_upper
        self._fastest = VELOCITY_FACTOR * limits.velocity
        self.reset()

    def reset(self) -> None:
        """The next state is the first one."""
        self._last: tuple[float, Array, Array] | None = None
        self._other: tuple[float, Array, Array] | None = None
        self._in_a_row = 0
        self.jumped = ""  # what jumped in the last checked state, "" = nothing

    def resume(self) -> None:
        """States were missed: the next one may be anywhere inside the limits."""
        if self._last is not None:
            self._last = (-np.inf, *self._last[1:])

    def check(self, state: RobotState) -> None:
        """Accept a state, or raise an error.

        Raises:
            ImplausibleStart: the first state has a joint outside its limits.
            InvalidValue: a joint or the base further outside, faster, or elsewhere than it can
                be, or a wrench too large; names the field, what was given and expected.
        """
        na = len(self._names)
        q, v = state.q[-na:], state.v[-na:]
        self.jumped = ""
        if self._last is None:
            self._inside(q, START_MARGIN, ImplausibleStart)
        self._inside(q, POSITION_MARGIN, InvalidValue)
        if (np.abs(v) > self._fastest).any():
            j = int(np.argmax(np.abs(v) / self._fastest))
            raise InvalidValue(
                f"joint_states.velocity: {v[j]:g} rad/s at '{self._names[j]}' given, at most "
                f"{self._fastest[j]:g} rad/s ({VELOCITY_FACTOR:g} times its limit) expected"
            )
        if len(state.v) > na:
            check_base(state.q[:7], state.v[:6])
        check_wrenches(state.wrenches, self._weight)
        now = (state.time, state.q.copy(), state.v.copy())
        jump = self._jump(self._last, now)
        if jump:
            agrees = self._other is not None and not self._jump(self._other, now)
            self._in_a_row = self._in_a_row + 1 if agrees else 1
            self._other = now
            if self._in_a_row < CONFIRMATIONS:
                raise InvalidValue(jump)
            self.jumped = jump
        self._last, self._other, self._in_a_row = now, None, 0

    def _inside(self, q: Array, margin: float, kind: type[InvalidValue]) -> None:
        excess = np.maximum(self._lower - q, q - self._upper)
        if (excess > margin).any():
            j = int(np.argmax(excess))
            raise kind(
                f"joint_states.position: {q[j]:g} rad at '{self._names[j]}' given, "
                f"{self._lower[j]:g} to {self._upper[j]:g} rad (its limits) or at most "
                f"{margin:g} rad outside expected"
            )

    def _jump(
        self, before: tuple[float, Array, Array] | None, now: tuple[float, Array, Array]
    ) -> str:
        """What jumped between two states, "" = nothing."""
        if before is None or not np.isfinite(before[0]):
            return ""
        na, passed = len(self._names), now[0] - before[0]
        step = min(abs(passed), LONGEST_STEP)
        fastest = np.maximum(np.abs(before[2]), np.abs(now[2]))[-na:]
        moved = np.abs(now[1] - before[1])[-na:]
        excess = moved - JUMP - 2.0 * fastest * step
        if (excess > 0.0).any():
            j = int(np.argmax(excess))
            return (
                f"joint_states.position: '{self._names[j]}' moved by {moved[j]:g} rad at "
                f"{fastest[j]:g} rad/s within {passed:g} s"
            )
        if len(now[2]) == na:
            return ""
        earlier, later = ((q[:7], v[:6]) for _, q, v in (before, now))
        return base_jump(earlier, later, step, passed)
