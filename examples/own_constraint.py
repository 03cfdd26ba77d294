"""A constraint of one's own: the tool stays out of a sphere on its way to a target.

python examples/own_constraint.py
"""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from ghc_sim_bridge import Simulator

CENTER, RADIUS = [0.47, 0.11, 0.74], 0.08  # [m]
TARGET = [0.58, 0.08, 0.6]  # [m]


@ghc.register_constraint("keep_out")
class KeepOut(ghc.DistanceConstraint):
    """|p - center| >= radius [m] with p the origin of a frame; fields: frame, center, radius."""

    def __init__(self, name: str, frame: int, center: Any, radius: float):
        super().__init__(name, lower=radius, upper=np.inf, brake=2.0)  # brake [m/s^2]
        self.frame, self.center = frame, np.array(center)

    @classmethod
    def from_config(cls, fields: Any, model: Any) -> KeepOut:
        """From an entry of `constraints`."""
        frame = model.frame_id(fields.choice("frame", model.frame_names))
        center, radius = fields.numbers("center", 3), fields.number("radius")
        return cls(fields.text("name"), frame, center, radius)

    def measure(self, tick: Any) -> Any:
        """d = |p - center|: d' = u^T J_p v, d'' = u^T J_p x + drift."""
        frame = tick.model.frame(self.frame)
        velocity, away = frame.velocity[:3], frame.position - self.center
        d = float(np.linalg.norm(away))
        u = away / d
        drift = u @ frame.drift[:3] + (velocity @ velocity - (u @ velocity) ** 2) / d
        return d, float(u @ velocity), u @ frame.jacobian[:3], float(drift)


gains = {"stiffness": 30.0, "damping": 20.0}  # [1/s^2], [1/s]
tasks = [ghc.frame_position("hand", "tool", **gains), ghc.posture("posture", **gains)]
place: dict[str, Any] = {"frame": "tool", "center": CENTER, "radius": RADIUS}
sphere = {"kind": "keep_out", "name": "sphere", **place}
arm = ghc.load_robot("kuka_lwr").urdf
for constraints in ([], [sphere]):
    robot = ghc.Robot.from_urdf(arm, tasks, "hand > posture", constraints=constraints)
    simulator, controller = Simulator("kuka_lwr"), ghc.Controller(robot)
    controller.start(simulator.state())
    controller.set_reference("hand", TARGET)
    nearest, tool = np.inf, controller.model.frame_id("tool")
    while simulator.time < 6.0:
        simulator.step(controller.step(simulator.state()).torque)
        away = controller.model.frame_position(tool) - np.array(CENTER)
        nearest = min(nearest, float(np.linalg.norm(away)))
    left = controller.report().errors["hand"]
    print(f"{len(constraints)} constraints: nearest {nearest:.3f} m, {left:.3f} m from the target")
