"""One target out of reach, every formulation: what the first task and the torques make of it.

python examples/compare_formulations.py [seconds of simulation]
"""

from __future__ import annotations

import sys

import numpy as np

import ghc_controller as ghc
from ghc_sim_bridge import Simulator

PERIOD = 1e-3  # [s]


def run(formulation: str, seconds: float) -> tuple[float, float]:
    """Error of the first task at the end [m], largest torque rate of the second half [Nm/s]."""
    simulator = Simulator("kuka_lwr", control_dt=PERIOD)
    settings = ghc.Settings(formulation=formulation, control_dt=PERIOD)
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), settings)
    controller.start(simulator.state())
    controller.set_reference("end_effector", [0.9, 0.4, 0.9])  # [m], out of reach
    previous, rate = np.zeros(controller.model.na), 0.0
    while simulator.time < seconds:
        torque = controller.step(simulator.state()).torque
        if simulator.time > 0.5 * seconds:
            rate = max(rate, float(np.abs(torque - previous).max()) / PERIOD)
        previous = torque
        simulator.step(torque)
    return controller.report().errors["end_effector"], rate


def main() -> None:
    """One line a formulation."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 4.0
    for formulation in ghc.FORMULATIONS:
        error, rate = run(formulation, seconds)
        print(f"{formulation:22s} error {error:.4f} m, torque rate {rate:6.0f} Nm/s at 1 ms")


if __name__ == "__main__":
    main()
