"""Limits on joint accelerations: the box, its reader, and an arm that keeps them."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import ROBOTS, make_model, random_state

import ghc_controller as ghc
from ghc_controller.constraints import Tick
from ghc_controller.constraints.rows.joint_acceleration import JointAccelerationLimit
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_sim_bridge.simulation.simulator import Simulator

LIMIT = 2.0  # [rad/s^2]


@pytest.mark.parametrize("robot", ROBOTS)
def test_named_joints_are_bounded_and_nothing_else(robot: str) -> None:
    model, state = make_model(robot), random_state(robot, np.random.default_rng(1))
    named = (model.joint_names[2], model.joint_names[0])
    places = [model.nv - model.na + model.joint_names.index(name) for name in named]
    tick = Tick(model, model.update(state.q, state.v), state, None, 1e-3)
    rows = JointAccelerationLimit("gentle", model, LIMIT, named).rows(tick)
    assert sorted(np.flatnonzero(np.isfinite(rows.upper))) == sorted(places)
    assert np.array_equal(rows.upper[places], [LIMIT, LIMIT])
    assert np.array_equal(rows.lower, -rows.upper)
    every = JointAccelerationLimit("gentle", model, LIMIT).rows(tick)
    assert np.isfinite(every.upper).sum() == model.na
    with pytest.raises(UnknownName, match="known: "):
        JointAccelerationLimit("gentle", model, LIMIT, ["nothing"])
    with pytest.raises(InvalidValue, match="positive"):
        JointAccelerationLimit("gentle", model, 0.0)


def _largest(*constraints: dict[str, object]) -> tuple[float, float]:
    """Largest |dv| [rad/s^2] of a move of 0.2 m, and the distance that is left [m]."""
    robot = ghc.Robot.from_urdf(
        ghc.load_robot("kuka_lwr").urdf,
        tasks=[
            ghc.frame_position("hand", "tool", stiffness=30.0, damping=12.0),
            ghc.posture("posture", stiffness=30.0, damping=12.0),
        ],
        hierarchy="hand > posture",
        constraints=constraints,
    )
    simulator = Simulator("kuka_lwr", control_dt=1e-3)
    controller = ghc.Controller(robot, ghc.Settings.of(torque_rate_limit=0.0))
    controller.start(simulator.state())
    place = controller.model.frame_position(controller.model.frame_id("tool"))
    controller.set_reference("hand", (place - [0.0, 0.2, 0.0]).tolist())
    speeds = []
    for _ in range(1500):
        speeds.append(simulator.state().v)
        simulator.step(controller.step(simulator.state()).torque)
    errors = controller.report().errors
    return float(np.abs(np.diff(speeds, axis=0)).max() / 1e-3), errors["hand"]


def test_an_arm_keeps_the_limit_and_gets_there() -> None:
    free, _ = _largest()
    entry = {"kind": "joint_acceleration", "name": "gentle", "limit": LIMIT}
    limited, left = _largest(entry)
    assert free > 2.0 * LIMIT
    assert limited < 1.02 * LIMIT
    assert left < 0.02
