"""A contact of kind `rolling` in closed loop: a ball at the tool of an arm rolls on a table."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import ghc_controller as ghc
from ghc_sim_bridge import Simulator, load_scene

RADIUS = 0.02  # [m] of the ball of the scene
FORCE = 20.0  # [N]
NORMAL = np.array([0.0, 0.0, 1.0])


def _arm() -> ghc.Robot:
    gains = {"stiffness": 100.0, "damping": 20.0}
    entry: dict[str, Any] = {
        "name": "tool",
        "frame": "tool",
        "points": [[0, 0, 0]],
        "normal": [0, 0, 1],
    }
    entry |= {"kind": "rolling", "radius": RADIUS, "friction": 0.5, "active": True}
    entry |= {"force_lower": FORCE, "force_upper": FORCE}
    return ghc.Robot.from_urdf(
        ghc.load_robot("kuka_lwr").urdf,
        tasks=[
            ghc.frame_position("hand", "tool", axes=["x", "y"], **gains),
            ghc.posture("posture", stiffness=30.0, damping=20.0),
        ],
        hierarchy="hand > posture",
        contacts=[entry],
    )


def _roll() -> tuple[float, float, float]:
    """Way of the tool [m], turn of the ball about x [rad], fastest slip of what touches [m/s]."""
    scene = load_scene("kuka_lwr_push")  # friction 0.8 in the simulation
    soft = replace(scene.contacts[0], time_constant=0.02, damping_ratio=1.0)
    simulator = Simulator(replace(scene, contacts=(soft,)), control_dt=1e-3)
    q = simulator.state().q
    for _ in range(50):  # on the table
        error = np.array([0.55, 0.0, 0.2999]) - simulator.frame_position("tool")
        q = q + np.linalg.pinv(simulator.frame_jacobian("tool")[:3]) @ error
        simulator.reset(q)
    controller = ghc.Controller(_arm(), ghc.Settings(torque_rate_limit=0.0))
    controller.start(simulator.state())
    controller.set_reference("hand", [0.55, 0.012], start=0.2)  # [m]
    slip, turn, begin = 0.0, 0.0, simulator.frame_position("tool")[1]
    while simulator.time < 1.2:
        simulator.step(controller.step(simulator.state()).torque)
        velocity = simulator.frame_jacobian("tool") @ simulator.state().v
        touching = velocity[:3] - np.cross(velocity[3:], RADIUS * NORMAL)
        turn += 1e-3 * float(velocity[3])
        if simulator.time > 0.1:
            slip = max(slip, float(np.linalg.norm(touching[:2])))
    assert abs(simulator.contact_wrenches()["tool"][2] - FORCE) < 0.5
    return float(simulator.frame_position("tool")[1] - begin), turn, slip


def test_the_ball_rolls_over_the_table_without_slipping() -> None:
    """12 mm to the side are a turn of -0.6 rad; what touches is slower than 2 mm/s."""
    way, turn, slip = _roll()
    assert abs(way - 0.012) < 5e-4
    assert abs(turn + way / RADIUS) < 0.02
    assert slip < 2e-3
