"""Gains and formulation change while the arm moves, by a blend and at once.

python examples/tune_while_running.py
"""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from ghc_sim_bridge import Simulator

PERIOD = 1e-3  # [s]
CHANGE: dict[str, Any] = {"tasks.end_effector.stiffness": 90.0, "formulation": "balanced"}


def run(duration: float | None) -> tuple[float, float]:
    """Largest torque rate [Nm/s] from the change on, error [m] at the end.

    Args:
        duration: [s] of the blend; None: nothing changes.
    """
    simulator = Simulator("kuka_lwr", control_dt=PERIOD)
    settings = ghc.Settings.of(torque_rate_limit=0.0)
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), settings)
    controller.start(simulator.state())
    controller.set_reference("end_effector", [0.5, 0.3, 0.6])  # [m]
    previous, rate = simulator.torque, 0.0
    while simulator.time < 2.5:
        if simulator.tick == 1000 and duration is not None:
            controller.tune(CHANGE, duration)
        torque = controller.step(simulator.state()).torque
        if simulator.tick >= 1000:
            rate = max(rate, float(np.abs(torque - previous).max()) / PERIOD)
        previous = torque
        simulator.step(torque)
    return rate, controller.report().errors["end_effector"]


def main() -> None:
    """One line a way of changing."""
    for words, duration in (("no change", None), ("at once", 0.0), ("in a second", 1.0)):
        rate, error = run(duration)
        print(f"{words:11s} {rate:6.0f} Nm/s at 1 ms, {1e3 * error:.1f} mm left at the end")


if __name__ == "__main__":
    main()
