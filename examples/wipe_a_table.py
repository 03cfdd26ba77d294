"""A sliding contact: the tool presses on a table with 15 N and wipes along it.

python examples/wipe_a_table.py
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import ghc_controller as ghc
from ghc_sim_bridge import Simulator, load_scene

GAINS = {"stiffness": 100.0, "damping": 20.0}  # [1/s^2], [1/s]
FRICTION = 0.3  # [-] of the simulated table, here taken to be known
FORCE = 15.0  # [N]
TOOL: dict[str, Any] = {
    "name": "tool",
    "kind": "sliding",  # held along the normal alone, friction against the motion
    "frame": "tool",
    "points": [[0, 0, 0]],
    "normal": [0, 0, 1],
    "friction": FRICTION,
    "force_lower": FORCE,  # [N] both bounds: this force
    "force_upper": FORCE,
    "active": True,
}


def main() -> None:
    """Print place and normal force of the tool while it wipes to the side."""
    scene = load_scene("kuka_lwr_push")  # the tool 1 cm above a table
    cloth = replace(scene.contacts[0], friction=FRICTION, time_constant=0.05)
    simulator = Simulator(replace(scene, contacts=(cloth,)))
    names, start = simulator.joint_names, simulator.state().q
    robot = ghc.Robot.from_urdf(
        ghc.load_robot("kuka_lwr").urdf,
        tasks=[
            ghc.frame_position("tool", frame="tool", axes=["x", "y"], **GAINS),
            ghc.posture("posture", reference=dict(zip(names, start, strict=True)), **GAINS),
        ],
        hierarchy="tool > posture",
        contacts=[TOOL],
    )
    controller = ghc.Controller(robot)
    controller.start(simulator.state())
    task = controller.references.task("tool")
    times, points = np.array([1.0, 3.0]), np.array([[0.55, 0.0], [0.55, 0.15]])  # [s], [m]
    controller.add_reference(ghc.ReferenceTrajectory.for_task(task, times, points))
    while simulator.time < 4.0 - 1e-9:
        simulator.step(controller.step(simulator.state()).torque)
        if simulator.tick % 1000 == 0:
            y, force = simulator.frame_position("tool")[1], simulator.contact_wrenches()["tool"]
            print(f"t = {simulator.time:.0f} s: y = {y:.3f} m, {force[2]:.1f} N")


if __name__ == "__main__":
    main()
