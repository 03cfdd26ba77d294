"""References of target streams: within limits, without steps, at the nearest point in the end."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName
from ghc_controller.numerics.rotation import rotation_exp
from ghc_controller.reachable import JointLimitsOfMotion, ReachableReference, ReachableSettings
from ghc_controller.reachable.joint_motion import JointMotion
from ghc_controller.reachable.tangent import difference, moved
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.robot.library import find_robot, load_robot
from ghc_controller.robot.robot import Robot
from ghc_controller.robot.task_entries import frame_pose
from ghc_controller.tasks.python.local_frame import LocalPositionTask
from ghc_controller.types import Array, RobotState

Q = np.array([0.1, 0.1, 0.2, 1.2, -0.5, -0.8, 0.0])
TASK = "end_effector"
PLAN = 0.01  # [s]


def _position(q: Array) -> Array:
    robot = load_robot("kuka_lwr")
    robot.model.update(q, np.zeros(7))
    return robot.tasks[0].current(robot.model).copy()


def _run(
    reference: ReachableReference, targets: list[tuple[float, Array]], end: float
) -> tuple[Array, list[ReferenceTrajectory]]:
    """(T, 3, n) joint motion and the trajectories of the first task."""
    motion: list[Array] = []
    sent: list[ReferenceTrajectory] = []
    waiting = list(targets)
    for k in range(round(end / PLAN)):
        now = k * PLAN
        while waiting and waiting[0][0] <= now:
            stamp, position = waiting.pop(0)
            reference.add(TASK, position, now, stamp)
        sent += reference.plan(RobotState(now, Q, np.zeros(7)))[:1]
        if reference.has_begun:
            motion.append(reference.joint_motion)
    return np.concatenate(motion), sent


def _random_targets(seed: int, end: float) -> list[tuple[float, Array]]:
    """20 Hz, a tenth lost, noise of 1 mm, jumps of up to 0.3 m per axis once a second."""
    random = np.random.default_rng(seed)
    center, found = _position(Q), []
    for k in range(1, int(20 * end)):
        if k % 20 == 0:
            center = _position(Q) + random.uniform(-0.3, 0.3, 3)
        if random.random() > 0.1:
            found.append((k / 20.0, center + random.normal(0.0, 1e-3, 3)))
    return found


@pytest.mark.parametrize("seed", range(3))
def test_the_motion_keeps_its_limits_and_is_one(seed: int) -> None:
    """q, v and a within limits at every ms, and q, v the integrals of v, a."""
    reference = ReachableReference(load_robot("kuka_lwr"), [TASK])
    limits = reference.limits.containing(Q)
    motion, _ = _run(reference, _random_targets(seed, 3.0), 3.0)
    q, v, a = motion[:, 0], motion[:, 1], motion[:, 2]
    assert (q >= limits.lower - 1e-9).all()
    assert (q <= limits.upper + 1e-9).all()
    assert (np.abs(v) <= limits.velocity + 1e-9).all()
    assert (np.abs(a) <= limits.acceleration + 1e-9).all()
    assert np.abs(v).max() > 0.3  # it moved
    assert np.abs(np.diff(v, axis=0) - 1e-3 * a[1:]).max() < 1e-9
    assert np.abs(np.diff(q, axis=0) - 0.5e-3 * (v[1:] + v[:-1])).max() < 1e-9
    assert np.abs(np.diff(a, axis=0)).max() < 0.3  # [rad/s^2] per ms: 4 A / window


@pytest.mark.parametrize("seed", range(3))
def test_an_answer_to_a_jump_begins_and_brakes_within_the_jerk_limit(seed: int) -> None:
    """Goals at rest 0.4 to 1 rad away: until all joints are near, no jerk beyond the limit."""
    random = np.random.default_rng(seed)
    limits = JointLimitsOfMotion.of(load_robot("kuka_lwr").model, ReachableSettings())
    way = random.uniform(0.4, 1.0, 7) * random.choice([-1.0, 1.0], 7)
    goal = np.clip(Q + way, limits.lower, limits.upper)
    goal = np.where(np.abs(goal - Q) < 0.3, Q - way, goal)
    motion = JointMotion(limits, 0.12, Q)
    rows = np.concatenate([motion.advance(goal, np.zeros(7), 10) for _ in range(300)])
    far = np.abs(goal - rows[1:, 0]) > 0.05
    jerk = np.abs(np.diff(rows[:, 2], axis=0)) / 1e-3
    assert jerk[far].max() <= 12.0 + 1e-6
    assert np.abs(rows[-1, 0] - goal).max() < 1e-6  # and it comes to rest there
    assert np.abs(rows[-1, 1:]).max() < 1e-5
    assert (np.sign(goal - Q) * (rows[:, 0] - goal)).max() < 1e-3  # without going beyond


def test_plans_meet_without_a_step_and_end_at_rest() -> None:
    reference = ReachableReference(load_robot("kuka_lwr"), [TASK])
    _, sent = _run(reference, _random_targets(5, 2.0), 2.0)
    assert len(sent) > 100
    for earlier, later in pairwise(sent):
        a, b = earlier.target(later.start_time), later.target(later.start_time)
        assert np.abs(a.position - b.position).max() < 1e-9
        assert np.abs(a.velocity - b.velocity).max() < 1e-7
        assert np.abs(a.acceleration - b.acceleration).max() < 1e-6
        assert later.velocity is not None
        assert np.abs(later.velocity[-1]).max() < 1e-9


def test_a_target_that_stands_still_is_met() -> None:
    goal = _position(np.array([0.5, 0.6, -0.3, 1.4, 0.2, -0.6, 0.0]))
    reference = ReachableReference(load_robot("kuka_lwr"), [TASK])
    motion, sent = _run(reference, [(0.05 * k, goal) for k in range(1, 80)], 4.0)
    assert np.linalg.norm(_position(motion[-1, 0]) - goal) < 1e-6
    assert sent[-1].start_time < 3.5  # nothing is sent at rest
    assert np.abs(sent[-1].position[-1] - goal).max() < 1e-6


@pytest.mark.parametrize("seed", range(3))
def test_out_of_reach_it_ends_at_the_nearest_point(seed: int) -> None:
    """The nearest point of a far target lies on the line to the shoulder: the arm is stretched."""
    random = np.random.default_rng(seed)
    shoulder = _shoulder()
    direction = np.array([0.8, *random.uniform(-0.4, 0.4, 2)])
    goal = shoulder + 2.0 * direction / np.linalg.norm(direction)
    settings = ReachableSettings(largest_jump=3.0)
    reference = ReachableReference(load_robot("kuka_lwr"), [TASK], settings)
    motion, _ = _run(reference, [(0.05 * k, goal) for k in range(1, 120)], 6.0)
    end = _position(motion[-1, 0])
    reach = float(np.linalg.norm(_position(np.zeros(7)) - shoulder))  # stretched
    assert np.linalg.norm(end - goal) <= 2.0 - reach + 1e-3
    assert np.abs(motion[-1, 1]).max() < 1e-3


def _shoulder() -> Array:
    """Where the axes of joints 1 and 2 meet: the point that keeps its distance to the elbow."""
    robot = load_robot("kuka_lwr")
    frame = robot.model.frame_id("link_2")
    robot.model.update(Q, np.zeros(7))
    return robot.model.frame_position(frame).copy()


def test_a_pose_is_followed() -> None:
    tasks = [frame_pose(TASK, "tool", 30.0, 20.0)]
    urdf = find_robot("kuka_lwr").with_name("kuka_lwr.urdf")

    def robot() -> Robot:
        return Robot.from_urdf(urdf, tasks, TASK, name="arm")

    model = robot()
    goal_q = Q + np.array([0.2, 0.1, -0.1, 0.1, 0.2, 0.1, 0.3])
    model.model.update(goal_q, np.zeros(7))
    goal = model.tasks[0].current(model.model).copy()
    reference = ReachableReference(robot(), [TASK])
    motion, sent = _run(reference, [(0.05 * k, goal) for k in range(1, 100)], 5.0)
    model.model.update(motion[-1, 0], np.zeros(7))
    end = model.tasks[0].current(model.model)
    assert np.linalg.norm(end[:3] - goal[:3]) < 1e-6
    assert np.linalg.norm(difference(end[3:], goal[3:], True)) < 1e-6
    assert sent[0].position.shape[1] == 7


def test_it_starts_anew_where_the_robot_is_after_silence() -> None:
    reference = ReachableReference(load_robot("kuka_lwr"), [TASK])
    goal = _position(Q) + np.array([0.0, 0.1, 0.0])
    _run(reference, [(0.05 * k, goal) for k in range(1, 40)], 6.0)
    assert not reference.has_begun
    elsewhere = Q + 0.4
    reference.add(TASK, goal, 6.0)
    sent = reference.plan(RobotState(6.0, elsewhere, np.zeros(7)))
    assert np.abs(sent[0].position[0] - _position(elsewhere)).max() < 1e-9


def test_what_cannot_be_used_is_refused() -> None:
    robot = load_robot("kuka_lwr")
    with pytest.raises(UnknownName, match="end_effector"):
        ReachableReference(robot, ["hand"])
    with pytest.raises(ConfigurationError, match="at least one"):
        ReachableReference(robot, [])
    with pytest.raises(InvalidValue, match="each once"):
        ReachableReference(robot, [TASK, TASK])
    with pytest.raises(UnknownName, match="target stream"):
        ReachableReference(robot, [TASK]).add("elbow", np.zeros(3), 0.0)
    with pytest.raises(InvalidValue, match=r"period: .*\[0.005, 0.05\]"):
        ReachableSettings(period=1e-4)  # less than a step of the motion
    with pytest.raises(InvalidValue, match=r"velocity_share: a number in \(0, 1\] expected"):
        ReachableSettings(velocity_share=1.5)


def test_limits_lie_inside_those_of_the_robot() -> None:
    model = load_robot("kuka_lwr").model
    limits = JointLimitsOfMotion.of(model, ReachableSettings())
    assert np.allclose(limits.lower, model.position_lower + 0.05)
    assert np.allclose(limits.velocity, 0.8 * model.velocity_limit)


def test_a_turned_target_is_a_rotation_about_world_axes() -> None:
    turn = np.array([0.0, 0.0, 0.3])
    origin = rotation_exp(np.array([0.4, 0.0, 0.0]))
    assert np.allclose(difference(moved(origin, turn, True), origin, True), turn)


@pytest.mark.parametrize("within_reach", [True, False])
def test_a_floating_base_stays_where_a_motion_begins(within_reach: bool) -> None:
    """iCub's hand meets its target with the base held, or looks for a better posture: joints that
    do not move it stay. Points differ as their velocities say."""
    robot = load_robot("icub")
    task = next(task for task in robot.tasks if task.name == "left_hand")
    reference = ReachableReference(robot, [task.name])
    q = robot.model.q.copy()
    q[:3] += (0.3, -0.2, 0.6)
    arm = {"l_shoulder_pitch": -0.5, "l_shoulder_roll": 0.5, "l_elbow": 1.0}
    for name, value in arm.items():
        q[7 + robot.model.joint_names.index(name)] = value
    state = RobotState(0.0, q, np.zeros(robot.model.nv))
    robot.model.update(q, state.v)
    way = np.array([0.02, 0.03, 0.05])
    target = task.current(robot.model) + (way if within_reach else 20.0 * way)
    motion: list[Array] = []
    sent: list[ReferenceTrajectory] = []
    for k in range(250 if within_reach else 450):
        now = k * PLAN
        reference.add(task.name, target, now, now)
        sent += reference.plan(RobotState(now, q, state.v))
        motion.append(reference.joint_motion)
    rows = np.concatenate(motion)
    assert rows.shape[2] == robot.model.na
    assert (np.abs(rows[:, 2]) <= reference.limits.acceleration + 1e-9).all()
    other = ("l_hip", "l_knee", "l_ankle", "r_", "neck")
    still = [name.startswith(other) for name in robot.model.joint_names]
    assert np.abs(rows[:, 1, still]).max() < 1e-9
    q[-robot.model.na :] = rows[-1, 0]
    robot.model.update(q, state.v)
    assert (np.abs(task.current(robot.model) - target).max() < 1e-3) == within_reach
    pairs = ((each, each.velocity) for each in sent if each.velocity is not None)
    moving, velocity = max(pairs, key=lambda pair: np.abs(pair[1]).max())
    mean = 0.5 * (velocity[1:3] + velocity[:2])
    steps = np.diff(moving.position[:3], axis=0) / np.diff(moving.times[:3])[:, None]
    assert np.abs(steps - mean).max() < 1e-3 * np.abs(mean).max() + 1e-5


def test_references_of_a_task_in_the_axes_of_its_frame_are_those_of_the_world() -> None:
    """Its rows turn with the tool, positions and velocities of its references do not."""
    kuka = load_robot("kuka_lwr")
    local = LocalPositionTask(TASK, kuka.model, "tool", 30.0, 20.0)
    robots = [replace(kuka, tasks=(task,), hierarchy=TASK) for task in (kuka.tasks[0], local)]
    targets = [(0.0, _position(Q) + [0.1, 0.0, 0.0])]
    runs = [_run(ReachableReference(robot, [TASK]), targets, 0.3)[1] for robot in robots]
    assert np.abs(runs[0][-1].velocity).max() > 0.05
    for world, turned in zip(*runs, strict=True):
        assert np.allclose(turned.velocity, world.velocity, atol=1e-9)
        assert np.allclose(turned.acceleration, world.acceleration, atol=1e-9)
