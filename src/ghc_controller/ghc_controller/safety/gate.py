"""Last stage of the controller: finite torques within torque limits and rate limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ghc_controller.core import Gate
from ghc_controller.safety.braking import braking_torque
from ghc_controller.safety.torque_gate import COUNTED_EXCESS, TorqueGate
from ghc_controller.types import Array, Dynamics

# Names of gate events, as in OutputGate.counts.
NOT_FINITE = "gate_not_finite"  # the torque had NaN or inf: held by braking instead
TORQUE_LIMIT = "gate_torque_limit"  # outside the torque limits
TORQUE_RATE = "gate_torque_rate"  # changed faster than the rate limit
RATE_BROKEN = "gate_rate_broken"  # the limits alone demand a change above the rate limit
APPLIED_UNKNOWN = "gate_applied_unknown"  # the applied torque was not finite: rate not checked


@dataclass(frozen=True, slots=True)
class Output:
    """Output torque, and what the gate had to change."""

    torque: Array  # (a,) [Nm] fresh array
    hits: tuple[str, ...]  # names as above; empty when the input went through


class OutputGate:
    """Finite, inside the torque limits, and within the rate limit of the applied torque.

    If limits and rate exclude each other (the applied torque was outside the limits), the limits
    take precedence. `counts` has the number of ticks of each kind of event.
    """

    def __init__(self, torque_limit: Array, rate_limit: Array | float, control_dt: float) -> None:
        """Set up the gate.

        Args:
            torque_limit: (a,) [Nm] > 0, inf where there is none.
            rate_limit: [Nm/s], one number or (a,); 0 switches the rate check off.
            control_dt: [s] control period.

        Raises:
            InvalidValue: a limit that is not positive (the rate: negative or not finite).
        """
        self._gate = TorqueGate(torque_limit, rate_limit, control_dt)
        self.torque_limit = self._gate.torque_limit
        self.torque_step_limit = self._gate.torque_step_limit  # (a,) [Nm] per control period
        names = (NOT_FINITE, TORQUE_LIMIT, TORQUE_RATE, RATE_BROKEN, APPLIED_UNKNOWN)
        self.counts = dict.fromkeys(names, 0)

    @property
    def core(self) -> Gate:
        """The gate of the core, which clips as `apply` does."""
        return self._gate.core

    def apply(
        self,
        torque: Array,
        applied: Array | None,
        dynamics: Dynamics,
        velocity: Array,
        braking: Callable[[], Array] | None = None,
    ) -> Output:
        """Output torque.

        Args:
            torque: (a,) [Nm] of the formulation, any values.
            applied: (a,) [Nm] torque over the last period; None before the first one.
            dynamics, velocity: at this state, (n,); for the braking torque only.
            braking: gives that torque (a,) [Nm], where limits tighter than those of the gate hold;
                None = within those of the gate.
        """
        hits: list[str] = []
        gated = np.empty(torque.shape)
        finite, known, *left = self._gate.core.clip(torque, applied, gated)
        excess = tuple(left)
        if not (finite and known):
            if not finite:
                hits.append(NOT_FINITE)
                torque = self._hold(applied, dynamics, velocity, braking)
            if not known:  # nothing to measure the rate from
                hits.append(APPLIED_UNKNOWN)
                applied = None
            excess = self._gate.core.clip(torque, applied, gated)[2:]
        if max(excess) > COUNTED_EXCESS:
            kinds = zip((TORQUE_LIMIT, TORQUE_RATE, RATE_BROKEN), excess, strict=True)
            hits += [name for name, amount in kinds if amount > COUNTED_EXCESS]
        for name in hits:
            self.counts[name] += 1
        return Output(gated, tuple(hits))

    def _hold(
        self,
        applied: Array | None,
        dynamics: Dynamics,
        velocity: Array,
        braking: Callable[[], Array] | None,
    ) -> Array:
        """Braking torque; if that is not finite, the applied torque, else zero."""
        with np.errstate(all="ignore"):
            if braking is None:
                torque = braking_torque(dynamics, velocity, self.torque_limit)
            else:
                torque = braking()
        if np.isfinite(torque).all():
            return torque
        if applied is not None and np.isfinite(applied).all():
            return applied
        return np.zeros(self.torque_limit.shape)
