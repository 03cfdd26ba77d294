"""The torque that leaves: where the rate limit counts from, braking, and the gate."""

from __future__ import annotations

from functools import partial

import numpy as np

from ghc_controller.constraints import ConstraintSet
from ghc_controller.constraints.torque_limit import TorqueLimit
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.safety.braking import braking_torque
from ghc_controller.safety.gate import Output, OutputGate
from ghc_controller.safety.rate_anchor import RateAnchor
from ghc_controller.types import Array, RobotState


class TorqueOutput:
    """Torques within the limits of robot and previews, each within the rate of the one before."""

    def __init__(
        self, model: RobotModel, constraints: ConstraintSet, gate: OutputGate, control_dt: float
    ) -> None:
        """Nothing sent yet; `control_dt` is the control period [s]."""
        self.gate = gate
        self.anchor = RateAnchor(
            model.torque_limit, gate.torque_step_limit, control_dt, model.floating_base
        )
        self._model, self._constraints = model, constraints

    def reset(self) -> None:
        """Forget the torques that were sent."""
        self.anchor.reset()

    def before(self, state: RobotState) -> Array:
        """Torque (a,) [Nm] from which the rate limit counts, after `model.update`."""
        model = self._model
        return self.anchor.before(
            state, partial(braking_torque, model.dynamics, state.v, model.torque_limit)
        )

    def gated(
        self, torque: Array, before: Array, state: RobotState, contacts: ContactRows | None
    ) -> Output:
        """What leaves in answer to a state, noted as the anchor of the next one."""
        output = self.gate.apply(
            torque, before, self._model.dynamics, state.v, partial(self.braking, state, contacts)
        )
        self.anchor.sent(output.torque, state.time)
        return output

    def braking(self, state: RobotState, contacts: ContactRows | None) -> Array:
        """Torque (a,) [Nm] that brakes, within all torque limits: the robot's, `torque_bound`, and
        those of previews.

        Where `torque_bound` around a gravity that is beyond a motor's limit leaves nothing, the
        motor's limit counts.
        """
        model = self._model
        most = model.torque_limit
        lower, upper = -most, most
        gravity = model.gravity()[-model.na :]
        for limit in self._constraints.constraints:
            if isinstance(limit, TorqueLimit):
                least, largest = limit.range_at(state.time, gravity)
                lower, upper = np.maximum(lower, least), np.minimum(upper, largest)
        lower, upper = np.minimum(lower, most), np.maximum(upper, -most)
        return braking_torque(
            model.dynamics, state.v, np.maximum(lower, upper), contacts, lower=lower
        )
