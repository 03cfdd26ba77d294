"""Joint velocities as a task: rows, and an arm that reaches and keeps a velocity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from model_states import ROBOTS, make_model, random_state, rows_of

import ghc_controller as ghc
from ghc_controller.errors import UnknownName
from ghc_controller.tasks.python.joint_velocity import JointVelocityTask
from ghc_controller.types import TaskTarget
from ghc_sim_bridge.simulation.simulator import Simulator


@pytest.mark.parametrize("robot", ROBOTS)
def test_rows_follow_velocity_and_acceleration(robot: str) -> None:
    """x = a* + kd (v* - v) on the chosen joints, without a stiffness."""
    rng = np.random.default_rng(5)
    model, state = make_model(robot), random_state(robot, rng)
    joints = (model.joint_names[2], model.joint_names[0])
    task = JointVelocityTask("v", model, 7.0, joints)
    given, change = rng.normal(size=(2, 2))
    model.update(state.q, state.v)
    rows = rows_of(task, model, state, TaskTarget(given, change, np.zeros(2)))
    measured = state.v[[model.nv - model.na + place for place in (2, 0)]]
    assert np.allclose(rows.jacobian @ state.v, measured)
    assert np.allclose(rows.error, given - measured)
    assert np.allclose(rows.target, change + 7.0 * (given - measured))
    with pytest.raises(UnknownName, match="known: "):
        JointVelocityTask("v", model, 7.0, ["nothing"])


def test_a_stiffness_that_is_tuned_has_no_effect() -> None:
    """As in robot.yaml; `damping` alone says how a velocity is followed."""
    robot = ghc.load_robot("kuka_lwr")
    task = JointVelocityTask("v", robot.model, 20.0)
    controller = ghc.Controller(replace(robot, tasks=(task,), hierarchy="v", contacts=()))
    state = ghc.RobotState(0.0, 0.3 * robot.model.position_upper, np.full(robot.model.na, 0.2))
    controller.start(state)
    before = controller.step(state).torque
    controller.tune({"tasks.v.stiffness": 50.0}, duration=0.0)
    assert np.array_equal(controller.step(state).torque, before)


def test_a_joint_turns_at_its_velocity_while_the_hand_stays() -> None:
    """Joint 3 is redundant for the position of the hand: it turns at 0.2 rad/s below that task."""
    kuka = ghc.load_robot("kuka_lwr")
    robot = ghc.Robot.from_urdf(
        kuka.urdf,
        tasks=[
            ghc.frame_position("hand", "tool", stiffness=100.0, damping=20.0),
            ghc.TaskEntry(
                "joint_velocity",
                "turn",
                0.0,
                20.0,
                {"joints": [kuka.model.joint_names[2]], "reference": [0.2]},
            ),
            ghc.posture("posture", stiffness=30.0, damping=20.0),
        ],
        hierarchy="hand > turn > posture",
    )
    simulator = Simulator("kuka_lwr", control_dt=1e-3)
    controller = ghc.Controller(robot)
    controller.start(simulator.state())
    for _ in range(600):
        simulator.step(controller.step(simulator.state()).torque)
    errors = controller.report().errors
    assert simulator.state().v[2] == pytest.approx(0.2, abs=0.01)
    assert errors["turn"] < 0.01
    assert errors["hand"] < 1e-3


def test_a_held_robot_comes_to_rest() -> None:
    """`hold` while joints move, also with a velocity in robot.yaml: they stop within a second."""
    robot = ghc.load_robot("kuka_lwr")
    task = JointVelocityTask("v", robot.model, 20.0, reference=np.full(robot.model.na, 0.3))
    controller = ghc.Controller(replace(robot, tasks=(task,), hierarchy="v", contacts=()))
    q, v, dt = robot.model.position_upper * 0.3, np.full(robot.model.na, 0.2), 1e-3
    controller.start(ghc.RobotState(0.0, q, v))
    controller.hold()
    for k in range(1000):
        x = controller.step(ghc.RobotState(k * dt, q, v)).solution.acceleration
        v = v + dt * x
        q = q + dt * v
    assert np.abs(v).max() < 1e-3
