"""Both hands of two arms are sent to one place; their bodies keep 3 cm apart.

python examples/arms_keep_apart.py
"""

from __future__ import annotations

import ghc_controller as ghc
from ghc_sim_bridge import Simulator

PLACE = [0.5, 0.0, 0.5]  # [m] wanted by both
DURATION = 3.0  # [s]


def main() -> None:
    """Print where the hands are, and which distance is at its margin."""
    simulator = Simulator("two_arms", control_dt=1e-3)
    controller = ghc.Controller(ghc.load_robot("two_arms"))
    controller.start(simulator.state())
    controller.set_reference("left_hand", PLACE)
    controller.set_reference("right_hand", PLACE)
    while simulator.time < DURATION - 1e-9:
        simulator.step(controller.step(simulator.state()).torque)
        if simulator.tick % 1000 == 0:
            left, right = (simulator.frame_position(f"{s}_tool")[1] for s in ("left", "right"))
            active = [name for name in controller.report().active_constraints if "hand" in name]
            print(f"t = {simulator.time:.0f} s: y = {left:.3f} m and {right:.3f} m, at {active}")


if __name__ == "__main__":
    main()
