"""Whether a measured state can be true: of this robot, and after the state before it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.model.limits import JointLimits
from ghc_controller.types import Array, RobotState

POSITION_MARGIN = 0.5  # [rad] beyond a position limit that a moving joint may be
START_MARGIN = 0.05  # [rad] the same where a controller starts
VELOCITY_FACTOR = 10.0  # [-] of the velocity limit
JUMP = 0.05  # [rad] between what a joint's velocity leads to and where it is
LONGEST_STEP = 0.1  # [s] over which a velocity says where a joint will be
CONFIRMATIONS = 3  # [-] states in a row that agree with each other make a jump believable


class ImplausibleStart(InvalidValue):
    """A pose in which a controller does not start."""


class StatePlausibility:
    """Checks states one after the other; a state that is refused leaves no trace.

    A jump of position that lasts is reported once (`jumped`), and then believed: whoever asks
    decides whether that is a fault.
    """

    def __init__(self, joint_names: Sequence[str], limits: JointLimits) -> None:
        """Limits (a,) of the joints [rad], [rad/s]."""
        self._names = tuple(joint_names)
        self._lower, self._upper = limits.position_lower, limits.position_upper
        self._fastest = VELOCITY_FACTOR * limits.velocity
        self.reset()

    def reset(self) -> None:
        """The next state is the first one."""
        self._last: tuple[float, Array, Array] | None = None
        self._other: tuple[float, Array, Array] | None = None
        self._in_a_row = 0
        self.jumped = ""  # what jumped with the state checked last, "" = nothing

    def resume(self) -> None:
        """States were missed: the next one may be anywhere inside the limits."""
        if self._last is not None:
            self._last = (-np.inf, *self._last[1:])

    def check(self, state: RobotState) -> None:
        """Take a state, or say what is wrong with it.

        Raises:
            ImplausibleStart: the first state has a joint outside its limits.
            InvalidValue: a joint further outside, faster, or elsewhere than it can be; names the
                field, the joint, what was given and expected.
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
        now = (state.time, q.copy(), v.copy())
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
        step = min(abs(now[0] - before[0]), LONGEST_STEP)
        fastest = np.maximum(np.abs(before[2]), np.abs(now[2]))
        moved = np.abs(now[1] - before[1])
        excess = moved - JUMP - 2.0 * fastest * step
        if not (excess > 0.0).any():
            return ""
        j = int(np.argmax(excess))
        return (
            f"joint_states.position: '{self._names[j]}' moved by {moved[j]:g} rad at "
            f"{fastest[j]:g} rad/s within {now[0] - before[0]:g} s"
        )
