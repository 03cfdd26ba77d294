"""Controllers of one Robot share nothing: neither its model nor gains, limits or previews."""

from __future__ import annotations

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.previews.preview import JOINT_LIMITS, Preview
from ghc_controller.previews.status import PreviewStatus

WALL = {"name": "wall", "kind": "cartesian_wall", "frame": "tool", "point": [0.9, 0, 0]}


def _robot() -> ghc.Robot:
    urdf = ghc.load_robot("kuka_lwr").urdf
    return ghc.Robot.from_urdf(
        urdf,
        [
            ghc.frame_position("hand", "tool", stiffness=30.0, damping=20.0),
            ghc.posture("posture", stiffness=30.0, damping=20.0),
        ],
        "hand > posture",
        constraints=[WALL | {"normal": [-1, 0, 0]}],
    )


def _state(seed: int) -> ghc.RobotState:
    rng = np.random.default_rng(seed)
    return ghc.RobotState(0.0, rng.uniform(-1.0, 1.0, 7), rng.uniform(-0.1, 0.1, 7))


def _plan() -> Preview:
    upper = np.full((1, 2), 0.3)
    return Preview(
        *(JOINT_LIMITS, 0.0, 1.0, ("joint_1",), -upper, upper),
        *((True,), (PreviewStatus.RAW,), (False,), False),
    )


def test_a_step_of_one_leaves_the_problem_of_the_other_alone() -> None:
    robot = _robot()
    one, other = ghc.Controller(robot), ghc.Controller(robot)
    one.start(_state(1))
    one.step(_state(1))
    before = one.problem()
    other.step(_state(2))
    np.testing.assert_array_equal(one.problem().mass_matrix, before.mass_matrix)
    np.testing.assert_array_equal(one.model.q, _state(1).q)


@pytest.mark.parametrize(
    "values",
    [
        {"tasks.hand.stiffness": 90.0},
        {"velocity_limit": 0.01},
        {"torque_rate_limit": 10.0},
    ],
)
def test_tuning_one_leaves_the_other_and_the_robot_alone(values: dict[str, float]) -> None:
    robot, state = _robot(), _state(3)
    one, other = ghc.Controller(robot), ghc.Controller(robot)
    for controller in (one, other):
        controller.start(state)
        controller.set_reference("hand", [0.3, 0.3, 0.8])
    expected = ghc.Controller(_robot())
    expected.start(state)
    expected.set_reference("hand", [0.3, 0.3, 0.8])
    one.tune(values)
    one.tuning.finish()
    one.step(state)
    np.testing.assert_array_equal(other.step(state).torque, expected.step(state).torque)
    np.testing.assert_array_equal(robot.model.velocity_limit, _robot().model.velocity_limit)
    assert (robot.tasks[0].stiffness == 30.0).all()


def test_a_preview_is_followed_by_one_alone() -> None:
    robot, state = _robot(), _state(4)
    one, other = ghc.Controller(robot), ghc.Controller(robot)
    for controller in (one, other):
        controller.start(state)
    one.follow(_plan())
    one.step(state)
    assert not any(limits.planned for limits in other.constraints.limits)
    walls = [controller.constraints.constraints for controller in (one, other)]
    assert not set(map(id, walls[0])) & set(map(id, walls[1])), "constraints that both have"


def test_a_copy_has_the_handles_of_frames_and_limits_of_its_model() -> None:
    robot = _robot()
    robot.model.frame_id("elbow")
    robot.model.limits.torque[0] = 12.0
    copied, state = robot.copy(), _state(5)
    for model in (robot.model, copied.model):
        model.update(state.q, state.v)
    for name in ("tool", "elbow"):
        handle = robot.model.frame_id(name)
        assert copied.model.frame_id(name) == handle
        np.testing.assert_array_equal(
            copied.model.frame_jacobian(handle), robot.model.frame_jacobian(handle)
        )
    assert copied.model.torque_limit[0] == 12.0
    copied.model.limits.torque[0] = 13.0
    assert robot.model.torque_limit[0] == 12.0
