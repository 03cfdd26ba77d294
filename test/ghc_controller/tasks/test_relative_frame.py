"""One frame seen from another: against Pinocchio, from YAML, and in closed loop on two robots."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from model_states import ROBOTS, make_model, pin_model, random_state

import ghc_controller as ghc
from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.numerics.rotation import matrix_from_quaternion
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.registry import make_task
from ghc_controller.tasks.relative_frame import RelativePoseTask, RelativePositionTask
from ghc_controller.types import Array


@pytest.mark.parametrize("robot", ROBOTS)
def test_pose_and_velocity_are_those_of_pinocchio(robot: str) -> None:
    """Seed 0, 10 states: A^-1 B, and the velocity of B minus that of A as B carries it, in A."""
    rng, model, plain = np.random.default_rng(0), make_model(robot), pin_model(robot)
    data = plain.createData()
    names = model.frame_names[2], model.frame_names[-1]
    task = RelativePoseTask("seen", model, names[1], names[0], 1.0, 1.0)
    for _ in range(10):
        state = random_state(robot, rng)
        model.update(state.q, state.v)
        pin.forwardKinematics(plain, data, state.q, state.v)
        pin.updateFramePlacements(plain, data)
        a, b = (plain.getFrameId(name, pin.FrameType.BODY) for name in names)
        relative = data.oMf[a].actInv(data.oMf[b])
        current = task.current(model)
        np.testing.assert_allclose(current[:3], relative.translation, atol=1e-12)
        np.testing.assert_allclose(
            matrix_from_quaternion(current[3:]), relative.rotation, atol=1e-12
        )
        va, vb = (pin.getFrameVelocity(plain, data, f, pin.ReferenceFrame.WORLD) for f in (a, b))
        seen = data.oMf[a].actInv(vb - va)  # twist of B against A at the origin of A
        expected = np.concatenate(
            [seen.linear + np.cross(seen.angular, relative.translation), seen.angular]
        )
        rows = task.measured(model, task.static_target(current))
        np.testing.assert_allclose(rows.jacobian @ state.v, expected, atol=1e-11)


def test_moving_the_base_of_a_floating_robot_changes_nothing() -> None:
    """Columns of the base and the error are zero, wherever the robot is: seed 1."""
    rng, model = np.random.default_rng(1), make_model("humanoid")
    task = RelativePoseTask("seen", model, model.frame_names[-1], model.frame_names[5], 1.0, 1.0)
    state = random_state("humanoid", rng)
    model.update(state.q, state.v)
    target = task.static_target(task.current(model))
    step = np.concatenate([rng.normal(size=6), np.zeros(model.na)])
    model.update(model.integrate(state.q, step), state.v)
    rows = task.measured(model, target)
    np.testing.assert_allclose(rows.error, 0.0, atol=1e-12)
    np.testing.assert_allclose(rows.jacobian[:, :6], 0.0, atol=1e-12)


LINK = "link_2"  # of the KUKA
HANDS = ("r_hand_dh_frame", "l_hand_dh_frame")  # of iCub
ENTRY = {"name": "seen", "frame": "tool", "stiffness": 30.0, "damping": 20.0}


def test_fields_of_robot_yaml() -> None:
    """Axes and reference are those of the frame it is seen from; both frames must differ."""
    model = make_model("kuka_lwr")
    first = model.frame_names[1]
    fields = ENTRY | {"kind": "relative_position", "relative_to": first}
    task = make_task(Fields(fields | {"axes": ["z"], "reference": [0.4]}, "robot.yaml"), model)
    assert isinstance(task, RelativePositionTask)
    assert (task.labels, task.frame, task.relative_to) == (("z",), "tool", first)
    assert task.default_target(model).position.tolist() == [0.4]
    pose = {"kind": "relative_pose", "reference": [0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0]}
    assert make_task(Fields(fields | pose, "robot.yaml"), model).size == 6
    with pytest.raises(InvalidValue, match=r"task 'seen', relative_to: another frame than 'tool'"):
        make_task(Fields(fields | {"relative_to": "tool"}, "robot.yaml"), model)
    with pytest.raises(ConfigurationError, match=r"relative_to: .*nose"):
        make_task(Fields(fields | {"relative_to": "nose"}, "robot.yaml"), model)


def _settled(robot: ghc.Robot, start: Array, task: str, goal: Array, seconds: float) -> Array:
    """Error of a task after some time, the robot moving as the controller computes."""
    controller, model, dt = ghc.Controller(robot), robot.model, 2e-3
    q, v, torque = start, np.zeros(model.nv), np.zeros(model.na)
    controller.start(ghc.RobotState(0.0, q, v, torque))
    controller.set_reference(task, goal)
    for k in range(round(seconds / dt)):
        result = controller.step(ghc.RobotState(k * dt, q, v, torque))
        torque = result.torque
        v = v + dt * result.solution.acceleration
        q = model.integrate(q, dt * v)
    return controller.stack.error_of(robot.task_names.index(task)).copy()


def test_an_arm_puts_its_tool_somewhere_as_seen_from_a_link() -> None:
    """KUKA: 5 cm back along x of the link and up along z, above the posture, to 1 um."""
    urdf = ghc.load_robot("kuka_lwr").urdf
    entry = ghc.TaskEntry(
        "relative_position", "reach", 30.0, 11.0, {"frame": "tool", "relative_to": LINK}
    )
    robot = ghc.Robot.from_urdf(
        urdf, [entry, ghc.posture("posture", 30.0, 11.0)], "reach > posture"
    )
    q = np.array([0.0, -0.6, 0.0, 1.6, 0.0, -0.9, 0.0])
    robot.model.update(q, np.zeros(7))
    goal = robot.tasks[0].current(robot.model) + np.array([-0.05, 0.0, 0.05])
    assert np.linalg.norm(_settled(robot, q, "reach", goal, 8.0)) < 1e-6


def test_two_hands_keep_their_pose_to_each_other_while_one_is_led_aside() -> None:
    """iCub's upper body: the led hand arrives, the other one goes with it, to 0.1 mm and mrad."""
    whole = ghc.load_robot("icub_upper_body")
    model = whole.model
    entries = (
        {"kind": "relative_pose", "name": "grip", "frame": HANDS[0], "relative_to": HANDS[1]},
        {"kind": "frame_position", "name": "lead", "frame": HANDS[1]},
        {"kind": "posture", "name": "posture"},
    )
    gains = {"stiffness": 30.0, "damping": 11.0}
    tasks = tuple(make_task(Fields(entry | gains, "test"), model) for entry in entries)
    robot = replace(whole, tasks=tasks, hierarchy="grip > lead > posture")
    middle = 0.5 * (model.position_lower + model.position_upper)
    q = np.clip(0.5 * middle, model.position_lower + 0.1, model.position_upper - 0.1)
    model.update(q, np.zeros(model.nv))
    goal = tasks[1].current(model) + np.array([0.0, 0.0, 0.04])
    assert np.linalg.norm(_settled(robot, q, "lead", goal, 4.0)) < 1e-4
    seen = tasks[0].current(model)
    model.update(q, np.zeros(model.nv))
    np.testing.assert_allclose(seen, tasks[0].current(model), atol=1e-4)
