"""Configurations as values: inverse kinematics by hand, and what an arm can carry on the way.

python examples/configurations.py
"""

from __future__ import annotations

import numpy as np

import ghc_controller as ghc

TARGET = [0.5, 0.2, 0.6]  # [m] of the tool
LOAD = [0.0, 0.0, -49.0]  # [N] on the tool: 5 kg


def main() -> None:
    """Print the start and the end: tool, manipulability, torques under the load."""
    arm = ghc.load_robot("kuka_lwr")
    start = arm.at([0.0, 0.2, 0.1, 1.0, -0.4, -0.9, 0.0])  # [rad], at rest
    here = start
    steps = 0
    while True:
        tool = here.frame("tool")
        error = np.array(TARGET) - tool.position
        if np.linalg.norm(error) < 1e-9 or steps == 50:
            break
        steps += 1
        here = here.moved(np.linalg.pinv(tool.jacobian[:3]) @ error)  # a new value each time
    print(f"{steps} steps, joints beyond a limit: {', '.join(here.outside_limits) or 'none'}")
    for words, one in (("start", start), ("end", here)):
        jacobian = one.frame("tool").jacobian[:3]
        measure = np.sqrt(np.linalg.det(jacobian @ jacobian.T))
        share = np.abs(one.gravity - jacobian.T @ LOAD) / arm.model.torque_limit
        worst = int(np.argmax(share))
        place = np.round(one.frame("tool").position, 3).tolist()
        print(f"{words}: tool at {place} m, manipulability {measure:.3f}")
        print(f"  with the load {one.joint_names[worst]} needs {100 * share[worst]:.0f} % of it")


if __name__ == "__main__":
    main()
