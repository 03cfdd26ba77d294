"""A contact of kind `sliding` in closed loop: the friction it assumes, and that of MuJoCo.

The ball at the tool of an arm is drawn over a table at 50 mm/s while its normal force follows a
reference. MuJoCo's convex contact lifts what slides, by mu v_t 2 / (F A_nn T) of the depth, with
the mobility A_nn along the normal and the time constant T of the contact: a hard contact (5 ms)
is lost again and again at any controller. T = 50 ms keeps that at a tenth.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

import ghc_controller as ghc
from ghc_controller.types import Array
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.simulation.simulator import Simulator

MU = 0.3  # [-]
START = np.array([0.5, -0.1, 0.2999])  # [m]
VELOCITY = np.array([0.0, 0.05, 0.0])  # [m/s]
BOTTOM = np.array([0.0, 0.0, -0.02])  # [m] from the center of the ball, world axes
DURATION = 1.4  # [s]
FORCES = ([0.0, 0.4, 0.9, 1.2], [[20.0], [20.0], [30.0], [15.0]])  # [s], [N]
SETTLED = 0.2  # [s]


class Slide(NamedTuple):
    """One row for each control period."""

    time: Array  # (k,) [s]
    assumed: Array  # (k, 3) [N] what the controller counts on
    simulated: Array  # (k, 3) [N] MuJoCo's, over the period
    asked: Array  # (k,) [N] reference of the normal force
    error: Array  # (k, 2) [m] of the tool in the plane


def _start() -> Simulator:
    """The tool on the table, moving already."""
    scene = load_scene("kuka_lwr_push")
    soft = replace(scene.contacts[0], friction=MU, time_constant=0.05, damping_ratio=1.0)
    simulator = Simulator(replace(scene, contacts=(soft,)), control_dt=1e-3)
    q = simulator.state().q
    for _ in range(50):
        error = START - simulator.frame_position("tool")
        q = q + np.linalg.pinv(simulator.frame_jacobian("tool")[:3]) @ error
        simulator.reset(q)
    twist = np.concatenate([VELOCITY, np.zeros(3)])
    simulator.reset(q, np.linalg.pinv(simulator.frame_jacobian("tool")) @ twist)
    return simulator


def _arm(friction: float, point: Array) -> ghc.Robot:
    stiff = {"stiffness": 100.0, "damping": 20.0}
    return ghc.Robot.from_urdf(
        ghc.load_robot("kuka_lwr").urdf,
        tasks=[
            ghc.frame_position("hand", "tool", **stiff),
            ghc.frame_orientation("turn", "tool", **stiff),
            ghc.posture("posture", stiffness=30.0, damping=20.0),
        ],
        hierarchy="hand > turn > posture",
        contacts=[
            {
                "name": "tool",
                "kind": "sliding",
                "frame": "tool",
                "points": [point.tolist()],
                "normal": [0, 0, 1],
                "friction": friction,
                "active": True,
                "force_task": {"weight": 1.0},
            }
        ],
    )


def _slide(friction: float) -> Slide:
    simulator = _start()
    state = simulator.state()
    model = ghc.load_robot("kuka_lwr").model
    model.update(state.q, state.v)
    point = model.frame(model.frame_id("tool")).rotation.T @ BOTTOM
    settings = ghc.Settings(torque_rate_limit=0.0)
    controller = ghc.Controller(_arm(friction, point), settings)
    controller.start(state)
    hand, force = controller.references.task("hand"), controller.force_references.task("tool")
    controller.add_reference(
        ghc.ReferenceTrajectory(
            "hand",
            hand.space,
            3,
            np.array([0.0, DURATION]),
            np.array([START, START + DURATION * VELOCITY]),
            np.array([VELOCITY, VELOCITY]),
        )
    )
    times, forces = np.array(FORCES[0]), np.array(FORCES[1])
    share = np.ones((len(times), 1))
    controller.add_reference(
        ghc.ReferenceTrajectory("tool", force.space, 1, times, share, wrench=forces)
    )
    rows = []
    for _ in range(round(DURATION / 1e-3)):
        result = controller.step(state)
        assert result.status is ghc.StepStatus.SOLVED
        frame = controller.model.frame(controller.model.frame_id("tool"))
        velocity = (frame.velocity[:3] + np.cross(frame.velocity[3:], BOTTOM))[:2]
        normal = result.solution.force
        assumed = np.append(-friction * normal * velocity / np.linalg.norm(velocity), normal)
        error = frame.position - START - VELOCITY * state.time
        time, asked = state.time, np.interp(state.time, times, forces[:, 0])
        simulator.step(result.torque)
        state = simulator.state()
        rows.append([time, *assumed, *state.wrenches["tool"][:3], asked, *error[:2]])
    log = np.array(rows)[round(SETTLED / 1e-3) :]
    return Slide(log[:, 0], log[:, 1:4], log[:, 4:7], log[:, 7], log[:, 8:])


def test_the_force_follows_while_the_tool_slides_and_friction_is_that_of_mujoco() -> None:
    """Normal force 15 to 30 N to 0.2 N, friction to 0.1 N of up to 9 N, the path to 0.5 mm."""
    slide = _slide(MU)
    assert np.abs(slide.simulated[:, 2] - slide.asked).max() < 0.2
    friction = slide.simulated[:, :2]
    assert np.linalg.norm(friction, axis=1).max() > 8.5
    assert np.linalg.norm(friction - slide.assumed[:, :2], axis=1).max() < 0.1
    assert np.linalg.norm(slide.error, axis=1).max() < 5e-4


def test_a_contact_without_friction_of_its_own_leaves_the_path() -> None:
    """Same table, a controller that counts on no friction: the tool stays behind."""
    slide = _slide(0.0)
    assert np.linalg.norm(slide.error, axis=1).max() > 0.02
