"""Postures as references: they meet the postures, their derivatives belong to them, soles stay."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_sim_bridge.analysis.task_errors import reference_trajectory
from ghc_sim_bridge.scenario.keyframe_references import keyframe_references
from ghc_sim_bridge.scenario.keyframes import Keyframe, Keyframes, joint_motion
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

NAMES = ("a", "b")
START = np.array([0.1, -0.2])
TWO = Keyframes(
    ("posture",), 0.1, (Keyframe(0.5, {}), Keyframe(1.3, {"a": 1.0}), Keyframe(2.0, {"b": 0.4}))
)
STEP = 1e-4  # [s] of the difference quotients


def test_the_joints_meet_every_posture_at_rest() -> None:
    wanted = {
        0.0: [0.1, -0.2],
        0.5: [0.1, -0.2],
        1.3: [1.0, -0.2],
        2.0: [1.0, 0.4],
        9.0: [1.0, 0.4],
    }
    for time, posture in wanted.items():
        motion = joint_motion(TWO, START, NAMES, time)
        np.testing.assert_allclose(motion.position, posture, atol=1e-12)
        np.testing.assert_allclose([*motion.velocity, *motion.acceleration], 0.0, atol=1e-9)


@pytest.mark.parametrize("time", [0.6, 0.9, 1.5, 1.95])
def test_velocity_and_acceleration_are_the_derivatives_of_the_posture(time: float) -> None:
    before, now, after = (joint_motion(TWO, START, NAMES, time + k * STEP) for k in (-1, 0, 1))
    velocity = (after.position - before.position) / (2.0 * STEP)
    acceleration = (after.velocity - before.velocity) / (2.0 * STEP)
    np.testing.assert_allclose(now.velocity, velocity, atol=1e-5)
    np.testing.assert_allclose(now.acceleration, acceleration, atol=1e-4)


def test_samples_are_no_farther_apart_than_asked_and_hold_the_keyframes() -> None:
    times = TWO.sample_times()
    assert np.diff(times).max() <= TWO.sample + 1e-9
    assert {0.5, 1.3, 2.0} <= {round(time, 9) for time in times}


@pytest.mark.parametrize(
    ("section", "problem"),
    [
        ({"tasks": [], "postures": [{"time": 0.0}]}, "tasks: a list of task names"),
        ({"tasks": ["posture"], "postures": []}, "postures: at least one entry"),
        ({"tasks": ["posture"], "postures": [{"time": 1.0}, {"time": 1.0}]}, "more than 1 s"),
        ({"tasks": ["posture"], "postures": [{"time": 1.0, "joint": {}}]}, "joint: unknown field"),
    ],
)
def test_a_wrong_section_is_refused_with_its_place(section: object, problem: str) -> None:
    with pytest.raises(ConfigurationError, match=problem):
        read(Fields(section, "mine.yaml", "keyframes"), Keyframes)


@pytest.fixture
def stand_up() -> Keyframes:
    """The postures of the scenario; `make test` installs the robot's model."""
    keyframes = load_scenario("stand_up").keyframes
    assert keyframes is not None
    return keyframes


def test_references_between_their_points_are_those_of_the_posture(stand_up: Keyframes) -> None:
    robot = load_robot_config(find_robot("icub"))
    references = keyframe_references(stand_up, "icub", "icub_seated")
    fine = Keyframes(stand_up.tasks, 0.025, stand_up.postures)
    exact = keyframe_references(fine, "icub", "icub_seated")
    for coarse, dense in zip(references, exact, strict=True):
        task = robot.tasks[robot.task_names.index(coarse.task)]
        trajectory = reference_trajectory(task, coarse, 7.0)
        for point in dense.points:
            target = trajectory.target(point.time)
            sign = 1.0
            if task.position_size != task.size:  # a quaternion and its negative are the same
                sign = np.sign(np.dot(target.position, point.position))
            np.testing.assert_allclose(sign * target.position, point.position, atol=2e-5)
            np.testing.assert_allclose(target.velocity, point.velocity, atol=1e-3)
            np.testing.assert_allclose(target.acceleration, point.acceleration, atol=5e-2)


def test_unknown_tasks_and_joints_and_feet_that_part_are_refused(stand_up: Keyframes) -> None:
    wrong_task = Keyframes(("nose",), 0.1, stand_up.postures)
    with pytest.raises(UnknownName, match="nose"):
        keyframe_references(wrong_task, "icub", "icub_seated")
    wrong_joint = Keyframes(stand_up.tasks, 0.1, (Keyframe(0.0, {"nose": 1.0}),))
    with pytest.raises(UnknownName, match="nose"):
        keyframe_references(wrong_joint, "icub", "icub_seated")
    one_leg = Keyframes(stand_up.tasks, 0.1, (Keyframe(0.0, {}), Keyframe(1.0, {"l_knee": -1.0})))
    with pytest.raises(ConfigurationError, match="r_sole would move"):
        keyframe_references(one_leg, "icub", "icub_seated")


def test_a_plan_has_the_references_of_the_postures(stand_up: Keyframes, tmp_path: Path) -> None:
    plan = make_plan(load_scenario("stand_up"), RunOptions(), tmp_path)
    assert {reference.task for reference in plan.scenario.references} >= set(stand_up.tasks)


def test_a_task_has_one_reference(stand_up: Keyframes, tmp_path: Path) -> None:
    scenario = load_scenario("stand_up", "force_task")
    twice = replace(scenario.references[0], task=stand_up.tasks[0])
    with pytest.raises(InvalidValue, match="two references"):
        make_plan(replace(scenario, references=(twice,)), RunOptions(), tmp_path)
