"""Targets of an operator at 20 Hz with jitter and loss, turned into a motion the arm can follow.

python examples/teleoperation_stream.py
"""

from __future__ import annotations

import numpy as np

import ghc_controller as ghc
from ghc_controller.reachable import ReachableReference
from ghc_sim_bridge import Simulator

PERIOD = 1e-3  # [s]


def operator(time: float) -> np.ndarray:
    """Where the operator wants the hand [m]: 5 cm to the sides and up, in 4 s."""
    phase = 0.5 * np.pi * time
    return np.array([0.5, 0.05 * np.sin(phase), 0.55 + 0.05 * (1.0 - np.cos(phase))])


def main() -> None:
    """Print how far the hand is from the operator, and the largest torque rate on the way."""
    simulator = Simulator("kuka_lwr", control_dt=PERIOD)
    controller = ghc.Controller(
        ghc.load_robot("kuka_lwr"), ghc.Settings.of(hierarchy="end_effector > posture")
    )
    controller.start(simulator.state())
    reference = ReachableReference(ghc.load_robot("kuka_lwr"), ["end_effector"])
    rng, due, lost = np.random.default_rng(0), 0.0, 0
    errors, previous, rate = [], simulator.torque, 0.0
    while simulator.time < 6.0:
        now = simulator.time
        if now >= due:  # a message arrives, unless it is lost
            due += 0.05 + rng.uniform(-0.005, 0.005)
            if rng.uniform() < 0.1:
                lost += 1
            else:
                reference.add("end_effector", operator(now), now, stamp=now)
        if simulator.tick % 10 == 0:
            for trajectory in reference.plan(simulator.state()):
                controller.add_reference(trajectory)
        torque = controller.step(simulator.state()).torque
        if now > 4.0:  # from the second turn on
            rate = max(rate, float(np.abs(torque - previous).max()) / PERIOD)
        previous = torque
        simulator.step(torque)
        if now > 4.0:
            errors.append(np.linalg.norm(simulator.frame_position("tool") - operator(now)))
    print(
        f"{lost} samples lost, hand {1e3 * np.mean(errors):.1f} mm from the operator in the mean"
    )
    print(f"largest torque rate {rate:.0f} Nm/s at a period of 1 ms")


if __name__ == "__main__":
    main()
