"""A generator of one's own: a joint limit that follows a line, never jumps, and moves an arm.

python examples/own_generator.py
"""

from __future__ import annotations

from typing import Any

import ghc_controller as ghc
from ghc_mpc_constraints import (
    BoundsGenerator,
    JointLimits,
    JointLimitSettings,
    LimitSchedule,
    register_generator,
)
from ghc_sim_bridge import Simulator

RATE = 0.3  # [rad/s]


@register_generator("ramped_joint_limits")
class RampedJointLimits(BoundsGenerator):
    """Moves each limit towards the raw one ahead at one rate; never looser than raw."""

    kind, settings_type, input = JointLimits.kind, JointLimitSettings, JointLimits.input

    def smooth(self, name: str, time: float, first: Any, raw: Any) -> Any:  # noqa: ARG002
        """Backwards from each raw limit at RATE, forwards from the current one."""
        lower, upper = raw.lower.copy(), raw.upper.copy()
        for j in range(len(upper) - 2, -1, -1):
            upper[j] = min(upper[j], upper[j + 1] + RATE * self.horizon.step)
            lower[j] = max(lower[j], lower[j + 1] - RATE * self.horizon.step)
        upper[0], lower[0] = first[1], first[0]
        for j in range(1, len(upper)):
            upper[j] = min(upper[j], upper[j - 1] + RATE * self.horizon.step)
            lower[j] = max(lower[j], lower[j - 1] - RATE * self.horizon.step)
        return lower[1:], upper[1:]


def main() -> None:
    """Print the current limit and the joint, which has to make room: 0.8 rad from 2 s on."""
    simulator = Simulator("kuka_lwr", control_dt=1e-3)
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), ghc.Settings.of(hierarchy="posture"))
    controller.start(simulator.state())
    generator = RampedJointLimits(JointLimitSettings())
    raw = LimitSchedule.checked("joint_4", times=[0.0, 2.0], lower=[-2.0] * 2, upper=[1.6, 0.8])
    generator.observe(raw, now=0.0)
    while simulator.time < 3.0:
        if simulator.tick % 10 == 0:
            controller.follow(generator.tick(simulator.time))
        simulator.step(controller.step(simulator.state()).torque)
        if simulator.tick % 500 == 0:
            limit, joint = controller.report().limits[0].upper, simulator.state().q[3]
            print(f"t = {simulator.time:.1f} s: limit {limit:.3f} rad, joint {joint:.3f} rad")


if __name__ == "__main__":
    main()
