"""A task of one's own: the distance of the tool from a point, one row, above the posture.

python examples/arm_own_task.py
"""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from ghc_sim_bridge import Simulator


@ghc.register_task("distance")
class DistanceTask(ghc.Task):
    """xi = |p - center| [m] with p the origin of a frame; fields: frame, center, gains."""

    def __init__(self, name: str, frame: int, center: Any, stiffness: float, damping: float):
        super().__init__(name, ["distance"], stiffness, damping)
        self.frame, self.center = frame, np.array(center)

    @classmethod
    def from_config(cls, fields: Any, model: Any) -> DistanceTask:
        """From an entry of `tasks`."""
        frame = model.frame_id(fields.choice("frame", model.frame_names))
        gains = [fields.number(name) for name in ("stiffness", "damping")]
        return cls(fields.text("name"), frame, fields.numbers("center", 3), *gains)

    def measure(self, model: Any, reference: Any, out: Any) -> None:
        """J = u^T J_p, and J' v = u^T J_p' v + (|v_p|^2 - (u^T v_p)^2) / xi."""
        frame = model.frame(self.frame)
        velocity, xi = frame.velocity[:3], self.current(model)
        u = (frame.position - self.center) / xi
        out.error[:] = reference.position - xi
        out.jacobian[:] = u @ frame.jacobian[:3]
        out.drift[:] = u @ frame.drift[:3] + (velocity @ velocity - (u @ velocity) ** 2) / xi

    def current(self, model: Any) -> Any:
        """The distance now, (1,)."""
        return np.array([np.linalg.norm(model.frame_position(self.frame) - self.center)])


gains = {"stiffness": 30.0, "damping": 20.0}  # [1/s^2], [1/s]
distance = ghc.TaskEntry("distance", "reach", 30.0, 20.0, {"frame": "tool", "center": [0, 0, 0.3]})
arm = ghc.load_robot("kuka_lwr").urdf
robot = ghc.Robot.from_urdf(arm, [distance, ghc.posture("posture", **gains)], "reach > posture")
simulator, controller = Simulator("kuka_lwr"), ghc.Controller(robot)
controller.start(simulator.state())
controller.set_reference("reach", [0.6])  # [m]
while simulator.time < 5.0:
    simulator.step(controller.step(simulator.state()).torque)
print(f"error of the distance: {1e3 * controller.report().errors['reach']:.3f} mm of 600 mm")
