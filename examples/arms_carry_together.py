"""Two arms as if they carried one object: a relative task holds the hands 60 cm apart.

python examples/arms_carry_together.py
"""

from __future__ import annotations

import numpy as np

import ghc_controller as ghc
from ghc_sim_bridge import Simulator

GAINS = {"stiffness": 100.0, "damping": 20.0}  # [1/s^2], [1/s]
LIFT = [0.0, 0.0, 0.1]  # [m]


def main() -> None:
    """Print how far the left hand has moved, and how far the grip was off on the way."""
    simulator = Simulator("two_arms")
    fields = {"frame": "right_tool", "relative_to": "left_tool"}
    robot = ghc.Robot.from_urdf(
        ghc.load_robot("two_arms").urdf,
        tasks=[
            ghc.TaskEntry("relative_pose", "grip", 100.0, 20.0, fields),
            ghc.frame_pose("left_hand", frame="left_tool", **GAINS),
            ghc.posture("posture", **GAINS),
        ],
        hierarchy="grip > left_hand > posture",
    )
    controller = ghc.Controller(robot)
    controller.start(simulator.state())  # tasks without a reference stay where they are
    left, right = (simulator.frame_position(f"{side}_tool") for side in ("left", "right"))
    pose = controller.references.task("left_hand").current(controller.model)
    controller.set_reference("left_hand", [*(left + LIFT), *pose[3:]])
    apart, worst = float(np.linalg.norm(right - left)), 0.0
    while simulator.time < 2.0:
        simulator.step(controller.step(simulator.state()).torque)
        hands = [simulator.frame_position(f"{side}_tool") for side in ("left", "right")]
        worst = max(worst, abs(float(np.linalg.norm(hands[1] - hands[0])) - apart))
    lifted = [1e3 * (now - before)[2] for now, before in zip(hands, (left, right), strict=True)]
    print(f"hands {apart:.2f} m apart, lifted by {lifted[0]:.1f} mm and {lifted[1]:.1f} mm")
    print(f"their distance was off by at most {1e3 * worst:.3f} mm on the way")


if __name__ == "__main__":
    main()
