"""Two tasks of an arm change places without a jump in torque.

python examples/arm_swap_priorities.py
"""

from __future__ import annotations

import numpy as np

import ghc_controller as ghc
from ghc_sim_bridge import Simulator

PERIOD = 1e-3  # [s]


def main() -> None:
    """Print the errors of all tasks, and the largest torque rate of the swap."""
    simulator = Simulator("kuka_lwr", control_dt=PERIOD)
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), ghc.Settings(control_dt=PERIOD))
    controller.start(simulator.state())
    controller.set_reference("end_effector", [0.61, 0.07, 0.82])  # [m]
    controller.set_reference("elbow", [0.0443, -0.3576, 0.4841])
    controller.change_hierarchy("elbow > end_effector > posture", start=4.0, duration=2.0)
    previous, rate = None, 0.0
    while simulator.time < 8.0:
        torque = controller.step(simulator.state()).torque
        if previous is not None and simulator.time > 4.0:
            rate = max(rate, float(np.abs(torque - previous).max()) / PERIOD)
        previous = torque
        simulator.step(torque)
        if simulator.tick % 4000 == 0:
            errors = {name: round(error, 3) for name, error in controller.report().errors.items()}
            print(f"t = {simulator.time:.0f} s: {errors}")
    print(f"largest torque rate after 4 s: {rate:.0f} Nm/s at a period of 1 ms")


if __name__ == "__main__":
    main()
