"""A humanoid moves its weight to the left foot and lifts the right one by 5 cm.

python examples/humanoid_lift_foot.py      (the model: pip install icub-models)
"""

from __future__ import annotations

import numpy as np

import ghc_controller as ghc
from ghc_mpc_constraints import ContactForceBounds, ContactSchedule, ForceBoundSettings
from ghc_sim_bridge import Simulator

PERIOD = 0.01  # [s]
UPRIGHT = [0.0, 0.0, 0.0, 1.0]  # quaternion x, y, z, w


def move(controller: ghc.Controller, task: str, times: list[float], points: list) -> None:
    """Let a task pass points (p, m) at times (p,) [s], at rest at each."""
    kind = controller.schedule_of(task).task(task)
    still = np.zeros((len(times), kind.size))
    path = ghc.ReferenceTrajectory.for_task(kind, np.array(times), np.array(points), still, still)
    controller.add_reference(path)


def main() -> None:
    """Print the height of the foot and the force below it."""
    robot = ghc.load_robot("icub")
    simulator = Simulator("icub_standing", PERIOD, joint_names=robot.model.joint_names)
    settings = ghc.Settings(
        control_dt=PERIOD,
        torque_rate_limit=0.0,
        hierarchy="center_of_mass > right_foot > root_orientation = chest_orientation = posture",
    )
    controller = ghc.Controller(robot, settings)
    controller.start(simulator.state())
    over_both, over_left = [0.0281, 0.0, 0.5224], [0.0281, 0.0701, 0.5224]  # [m]
    move(controller, "center_of_mass", [0.2, 1.8], [over_both, over_left])
    foot = [0.0, -0.0701]
    move(controller, "right_foot", [3.5, 4.5], [[*foot, z, *UPRIGHT] for z in (0.0099, 0.0599)])
    # The foot may carry less and less, and nothing from 3.5 s on.
    bounds = ContactForceBounds(ForceBoundSettings())
    times, lower, upper = [0.0, 1.9, 3.5], [15.0, 0.0, 0.0], [400.0, 45.0, 0.0]  # [s], [N]
    bounds.observe(ContactSchedule.checked("right_sole", times, lower, upper), 0.0)
    while simulator.time < 6.0:
        controller.force_bounds.follow(bounds.tick(simulator.time))
        simulator.step(controller.step(simulator.state()).torque)
        if simulator.tick % 100 == 0:
            force = simulator.contact_wrenches()["right_sole"][2]
            height = simulator.frame_position("r_sole")[2]
            print(f"t = {simulator.time:.0f} s: foot at {height:.3f} m, {force:5.1f} N below it")


if __name__ == "__main__":
    main()
