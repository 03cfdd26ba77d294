"""A robot written in Python instead of robot.yaml: tasks, gains and first hierarchy of a URDF.

python examples/own_robot_in_python.py [path of a URDF]
"""

from __future__ import annotations

import sys

import numpy as np

import ghc_controller as ghc

GAINS = {"stiffness": 30.0, "damping": 20.0}  # [1/s^2], [1/s]


def main() -> None:
    """Hold the arm of a URDF where it is, and print the torque for it."""
    urdf = sys.argv[1] if len(sys.argv) > 1 else ghc.load_robot("kuka_lwr").urdf
    robot = ghc.Robot.from_urdf(
        urdf, tasks=[ghc.posture("posture", **GAINS)], hierarchy="posture", name="mine"
    )
    last = robot.model.frame_names[-1]
    robot = ghc.Robot.from_urdf(
        urdf,
        tasks=[ghc.frame_position("hand", frame=last, **GAINS), ghc.posture("posture", **GAINS)],
        hierarchy="hand > posture",
        name="mine",
        limits={"torque_rate": 500.0},  # [Nm/s]
    )
    controller = ghc.Controller(robot)
    state = ghc.RobotState(0.0, np.full(robot.model.nq, 0.3), np.zeros(robot.model.nv))
    controller.start(state)
    result = controller.step(state)
    print(f"{robot.name}: {len(robot.model.joint_names)} joints, hand = frame '{last}'")
    print(f"{result.status.name}: torque {np.round(result.torque, 2).tolist()} Nm")


if __name__ == "__main__":
    main()
