"""An obstacle jumps towards the hand of an arm; the arm is shown one that moves.

python examples/obstacle_preview.py
"""

from __future__ import annotations

import ghc_controller as ghc
from ghc_mpc_constraints import Measurement, ObstacleBounds, ObstacleSettings
from ghc_sim_bridge import Simulator

SAFE = 0.10  # [m] to be kept
JUMP = 1.0  # [s]


def wall(at: float, hand: float) -> Measurement:
    """A wall behind the hand, across x; what a sensor says of it."""
    position, normal = [at, 0.0, 0.5], [-1.0, 0.0, 0.0]
    return Measurement.checked("wall", "tool", position, normal, max(at - hand, 0.0), SAFE)


def main() -> None:
    """Print where the wall is, where the controller takes it to be, and the hand."""
    simulator = Simulator("kuka_lwr", control_dt=1e-3)
    settings = ghc.Settings.of(torque_rate_limit=0.0, hierarchy="end_effector > posture")
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), settings)
    controller.start(simulator.state())
    controller.set_reference("end_effector", [0.55, 0.0, 0.5])
    generator = ObstacleBounds(ObstacleSettings())
    while simulator.time < JUMP + 3.0:
        hand = float(simulator.frame_position("tool")[0])
        place = 0.80 if simulator.time < JUMP else 0.60  # [m] it jumps by 20 cm
        if simulator.tick % 100 == 0:  # the sensor sees at 10 Hz
            generator.observe([wall(place, hand)], simulator.time)
        if simulator.tick % 10 == 0:
            preview = generator.tick(simulator.time)
            controller.follow(preview)
        simulator.step(controller.step(simulator.state()).torque)
        if simulator.tick % 500 == 0:
            virtual = preview.motion_at(0, simulator.time)[0, 0]
            words = f"wall at {place:.2f} m, for the controller at {virtual:.3f} m"
            print(f"t = {simulator.time:.1f} s: {words}, hand at {hand:.3f} m")


if __name__ == "__main__":
    main()
