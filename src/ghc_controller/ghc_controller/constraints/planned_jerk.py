"""The jerk with which position and velocity limits plan, from the torque rate limit."""

from __future__ import annotations

from ghc_controller.constraints.constraint import positive_per_joint
from ghc_controller.core import JerkPlan
from ghc_controller.types import Array, Dynamics, RobotState


class PlannedJerk:
    """j_k = kappa r_k / T_kk [rad/s^3]: what every joint can change its acceleration by at once.

    Torques T dx/dt = dtau/dt - delta within the rate r for any signs of all jerks: |T| j <=
    r - |delta|. T is the inertia of the joints with the base following them, delta
    [Nm/s] the drift of the torque at constant acceleration, G (dM/dt x + dh/dt), measured between
    the last two states and held with a memory of 50 ms. Derivation: docs/limits.md.

    With rows J (q, n) of contacts that are on, the base follows so that their points stay, as far
    as one joint alone can; without them it is free.

    Attributes:
        share: kappa of the last update.
        jerk: (a,) [rad/s^3] of the last update, which the next one overwrites.
        drift: (a,) [Nm/s] magnitude of delta in force.
        carried: (a, n) G = [B^T, 1] of the last update, where the base follows by x_b = B x_j: the
            torques of a generalized force w (n,) that the base does not take up are G w.
    """

    def __init__(self, rate: Array | float, joints: int) -> None:
        """Take the rate limit r [Nm/s], one number or (a,)."""
        self.rate = positive_per_joint(rate, joints, "torque_rate")
        self._use(JerkPlan(self.rate, joints))

    def reset(self) -> None:
        """Forget the last state and its drift."""
        self._core.reset()

    def core_of(self, n: int) -> JerkPlan:
        """The plan of the core for n velocity coordinates."""
        if self.carried.shape[1] != n:
            self._use(JerkPlan(self.rate, n))
        return self._core

    @property
    def share(self) -> float:
        """See the class."""
        return self._core.share

    def update(
        self, dynamics: Dynamics, state: RobotState, contacts: Array | None, dt: float
    ) -> Array:
        """Jerk (a,) at a state.

        Args:
            contacts: (q, n) motion rows of the contacts that are on; None without.
            dt: [s] control period.
        """
        core = self.core_of(dynamics.bias.shape[0])
        core.update(dynamics.mass_matrix, dynamics.bias, state.v, contacts, state.time, dt)
        return self.jerk

    def _use(self, core: JerkPlan) -> None:
        self._core = core
        self.jerk, self.drift, self.carried = core.jerk, core.drift, core.carried
