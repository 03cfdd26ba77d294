"""One control period of the bridge: gate, simulate, observe, log, in this order.

No ROS here: the node decides when a period runs and with which command.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np

from ghc_controller.safety.braking import braking_torque
from ghc_controller.safety.torque_gate import GatedTorque, TorqueGate
from ghc_controller.types import NANOSECONDS, Array, RobotState
from ghc_sim_bridge.logs.full_rate_log import FullRateLogBuffer, Source
from ghc_sim_bridge.simulation.simulator import Simulator
from ghc_sim_bridge.simulation.standing_hold import StandingHold

TAKEOVER_PERIODS = 2  # [-] one change by the controller, and one by the hold since the state


class BaseState(NamedTuple):
    """State of a floating base; empty for a fixed one."""

    pose: Array  # (7,) [m] and quaternion xyzw, world
    velocity: Array  # (6,) [m/s] and [rad/s], base axes


class ControlCycle:
    """The simulated robot, its time as an exact count of periods, and its log."""

    def __init__(
        self, simulator: Simulator, gate: TorqueGate, log: FullRateLogBuffer | None
    ) -> None:
        """Begin at the simulator's current state; adds a row per period to `log`, if any."""
        self.simulator = simulator
        self._gate = gate
        self._log = log
        # Stamps are whole nanoseconds: as multiples of this they never drift.
        self.period_ns = round(simulator.control_dt * NANOSECONDS)
        self.start_ns = 0  # [ns] stamp of the first state of this run
        self._standing = StandingHold()
        self._no_command = np.full(len(simulator.joint_names), np.nan)
        self._observe()
        self._stepped_at = time.perf_counter()

    def _observe(self) -> None:
        self.state: RobotState = self.simulator.state()
        self.run_ns = self.simulator.tick * self.period_ns  # [ns] since the start of the run
        self.time_ns = self.start_ns + self.run_ns  # [ns] never goes back
        q, v = self.joint_state
        # Once per state: a repeated state is identical.
        self.measured: tuple[Array, Array] = (q, self.simulator.measured_velocity(v))

    @property
    def joint_state(self) -> tuple[Array, Array]:
        """Positions (na,) [rad] and velocities (na,) [rad/s] of the joints."""
        na = len(self.simulator.joint_names)
        return self.state.q[-na:], self.state.v[-na:]

    @property
    def base(self) -> BaseState:
        """The base of the state."""
        na = len(self.simulator.joint_names)
        return BaseState(self.state.q[:-na], self.state.v[:-na])

    @property
    def epoch(self) -> int:
        """Count of resets: number of the run."""
        return self.state.epoch

    def reset(self) -> None:
        """Return to the start state, in the next epoch.

        Time continues: the run begins at a whole second, so that events at multiples of a period
        have the same times in every run. The gap is larger than the largest step of a stamp
        (`Timeline`), so that its states cannot be taken for those of the previous run.
        """
        self.start_ns = (self.time_ns // NANOSECONDS + 2) * NANOSECONDS
        self.simulator.reset()
        self._standing.release()
        self._observe()

    def continues(self, commanded: Array) -> bool:
        """Whether a command (n,) [Nm] is close to the applied torque.

        Within TAKEOVER_PERIODS of the rate limit, as is the first torque of a controller that
        takes over a robot at rest.
        """
        room = TAKEOVER_PERIODS * self._gate.torque_step_limit
        return bool((np.abs(commanded - self.simulator.torque) <= room).all())

    def advance(self, commanded: Array | None) -> GatedTorque:
        """Simulate one period under `commanded` (n,) [Nm], or held when there is none."""
        if commanded is not None:
            self._standing.release()
        gated = self._gate(
            self._hold_torque() if commanded is None else commanded, self.simulator.torque
        )
        self.simulator.step(gated.torque)
        if self._log is not None:
            self._record(self._log, commanded, gated)
        self._observe()
        return gated

    def _hold_torque(self) -> Array:
        simulator, gate = self.simulator, self._gate
        if simulator.floating_base:
            return self._standing.torque(
                simulator.dynamics(),
                simulator.contact_jacobian(),
                self.joint_state[0],
                self.state.v,
            )
        return braking_torque(
            simulator.dynamics(),
            self.state.v,
            gate.torque_limit,
            previous=simulator.torque,
            torque_step=gate.torque_step_limit,
            max_acceleration=np.inf,
        )

    def _record(self, log: FullRateLogBuffer, commanded: Array | None, gated: GatedTorque) -> None:
        if commanded is None:
            source = Source.HOLD
        elif gated.limit_hit or gated.rate_hit:
            source = Source.GATED
        else:
            source = Source.COMMAND
        now = time.perf_counter()
        log.append(
            self.time_ns / NANOSECONDS,
            now - self._stepped_at,
            (
                *self.joint_state,
                self.simulator.acceleration,
                gated.torque,
                self._no_command if commanded is None else commanded,
            ),
            self.state.wrenches,
            source,
            self.epoch,
            self.base if self.simulator.floating_base else (),
        )
        self._stepped_at = now
