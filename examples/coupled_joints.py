"""A coupling of joints as a constraint: two joints of an arm may bend by 1 rad together.

python examples/coupled_joints.py
"""

from __future__ import annotations

from typing import Any

import ghc_controller as ghc
from ghc_sim_bridge import Simulator

GAINS = {"stiffness": 30.0, "damping": 20.0}  # [1/s^2], [1/s]
BEND = {"joint_2": 0.9, "joint_4": 0.9}  # [rad] wanted: 1.8 together
COUPLING: dict[str, Any] = {
    "name": "fold",
    "kind": "joint_coupling",
    "coefficients": {"joint_2": 1.0, "joint_4": 1.0},
    "upper": 1.0,  # [rad]
}


def main() -> None:
    """Print both joints, without and with the coupling."""
    arm = ghc.load_robot("kuka_lwr")
    names = arm.model.joint_names
    wanted = {name: BEND.get(name, 0.0) for name in names}
    for constraints in ([], [COUPLING]):
        robot = ghc.Robot.from_urdf(
            arm.urdf,
            tasks=[ghc.posture("posture", reference=wanted, **GAINS)],
            hierarchy="posture",
            constraints=constraints,
        )
        simulator, controller = Simulator("kuka_lwr"), ghc.Controller(robot)
        simulator.reset([0.0] * len(names))
        controller.start(simulator.state())
        largest = 0.0  # [rad] of the sum, at any time
        while simulator.time < 4.0:
            simulator.step(controller.step(simulator.state()).torque)
            q = dict(zip(names, simulator.state().q, strict=True))
            largest = max(largest, q["joint_2"] + q["joint_4"])
        active = controller.report().active_constraints
        print(f"joints {q['joint_2']:.3f} and {q['joint_4']:.3f} rad, sum at most {largest:.4f}")
        print(f"active: {', '.join(active) or 'none'}")


if __name__ == "__main__":
    main()
