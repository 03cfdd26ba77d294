"""The arm goes down to a table and then pushes with 20 N along its normal.

python examples/arm_force_control.py
"""

from __future__ import annotations

import ghc_controller as ghc
from ghc_sim_bridge import Simulator

GAINS = {"stiffness": 30.0, "damping": 20.0}  # [1/s^2], [1/s]
ABOVE = {
    "joint_1": 0.0, "joint_2": -0.652, "joint_3": 0.0, "joint_4": 1.582,
    "joint_5": 0.0, "joint_6": -0.907, "joint_7": 0.0,
}  # fmt: skip


def main() -> None:
    """Print force and position while the tool goes down, touches and pushes."""
    # Row z turns to force control when the contact `tool` measures more than 1 N.
    force = {"axes": ["z"], "contact": "tool", "threshold": 1.0, "integral": 5.0}
    robot = ghc.Robot.from_urdf(
        ghc.load_robot("kuka_lwr").urdf,
        tasks=[
            ghc.frame_position("tool", frame="tool", force=force, **GAINS),
            ghc.posture("posture", reference=ABOVE, **GAINS),
        ],
        hierarchy="tool > posture",
    )
    simulator = Simulator("kuka_lwr_push")  # the tool 1 cm above the table
    controller = ghc.Controller(robot)
    controller.start(simulator.state())
    # 5 mm below the contact at z = 0.30 m, so that the tool touches while it still moves.
    controller.set_reference("tool", [0.55, 0.0, 0.295], wrench=[0.0, 0.0, -20.0])  # [m], [N]
    while simulator.time < 5.0:
        simulator.step(controller.step(simulator.state()).torque)
        if simulator.tick % 500 == 0:
            normal = simulator.contact_wrenches()["tool"][2]
            height = simulator.frame_position("tool")[2]
            print(f"t = {simulator.time:.1f} s: {normal:5.2f} N at z = {height:.4f} m")


if __name__ == "__main__":
    main()
