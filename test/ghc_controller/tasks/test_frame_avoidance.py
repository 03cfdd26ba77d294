"""The avoidance task: one row whose target is what the distance from a moving obstacle needs."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import make_model, random_state, rows_of

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.python.frame_avoidance import FrameAvoidanceTask
from ghc_controller.tasks.registry import make_task
from ghc_controller.types import Array, TaskTarget

STIFFNESS, DAMPING = 100.0, 20.0  # [1/s^2], [1/s]
DISTANCE, NEAR, FAR, RADIUS = 0.3, 1.0, 2.0, 0.1  # [m]


def _task(model: RobotModel) -> FrameAvoidanceTask:
    frame = model.frame_names[-1]
    return FrameAvoidanceTask("a", model, frame, STIFFNESS, DAMPING, DISTANCE, NEAR, FAR, RADIUS)


def _gap(model: RobotModel, q: Array, v: Array, obstacle: Array) -> float:
    task = _task(model)
    model.update(q, v)
    return task.gap(model, TaskTarget(obstacle, np.zeros(3), np.zeros(3)))


@pytest.mark.parametrize("moves", [False, True])
def test_rows_are_the_second_derivative_of_the_distance(moves: bool) -> None:
    """J dv + drift is d'' - what the obstacle does, by differences along a motion: 20 states."""
    rng = np.random.default_rng(0)
    model = make_model("kuka_lwr")
    task, h = _task(model), 1e-4
    for _ in range(20):
        state = random_state("kuka_lwr", rng)
        q, v, dv = state.q, state.v, rng.normal(size=model.nv)
        model.update(q, v)
        direction = rng.normal(size=3)
        o = model.frame_position(task._frame_id) + 0.6 * direction / np.linalg.norm(direction)
        o_v, o_a = (rng.normal(size=3), rng.normal(size=3)) if moves else np.zeros((2, 3))
        rows = rows_of(task, model, state, TaskTarget(o, o_v, o_a))
        d = 0.6 - RADIUS
        gaps = [
            _gap(model, q + t * v + 0.5 * t * t * dv, v + t * dv, o + t * o_v + 0.5 * t * t * o_a)
            for t in (-h, 0.0, h)
        ]
        rate = (gaps[2] - gaps[0]) / (2.0 * h)
        second = (gaps[2] - 2.0 * gaps[1] + gaps[0]) / h**2
        wanted = STIFFNESS * (DISTANCE - d) - DAMPING * rate
        assert rows.error == pytest.approx(DISTANCE - d)
        excess = float((rows.jacobian @ dv - rows.target)[0])
        assert excess == pytest.approx(second - wanted, abs=2e-4 * (1.0 + abs(second)))


def test_far_from_the_obstacle_the_frame_comes_to_rest() -> None:
    """Beyond `far` only the damping along the line is left, whatever the obstacle does."""
    rng = np.random.default_rng(1)
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", rng)
    task = _task(model)
    model.update(state.q, state.v)
    frame = model.frame(task._frame_id)
    obstacle = frame.position + np.array([0.0, FAR + 2.0 * RADIUS, 0.0])
    rows = rows_of(task, model, state, TaskTarget(obstacle, np.ones(3), np.ones(3)))
    assert rows.target == pytest.approx(DAMPING * frame.velocity[1] + frame.drift[1])
    assert rows.jacobian[0] == pytest.approx(-frame.jacobian[1])


def test_reference_is_the_position_of_the_obstacle() -> None:
    """Three numbers for one row, interpolated as those of a position; others are rejected."""
    model = make_model("kuka_lwr")
    task = _task(model)
    assert (task.size, task.position_size, task.reference_size) == (1, 3, 3)
    points, still = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 3.0]]), np.zeros((2, 3))
    path = ReferenceTrajectory.for_task(task, np.array([0.0, 2.0]), points, still, still)
    assert path.target(1.0).position == pytest.approx([0.0, 0.0, 2.0])
    assert path.target(1.0).velocity == pytest.approx([0.0, 0.0, 1.875])
    with pytest.raises(WrongSize, match=r"task 'a', position: .*\(3,\)"):
        task.static_target(np.zeros(1))
    above = task.default_target(model).position - model.frame_position(task._frame_id)
    assert above == pytest.approx([0.0, 0.0, 10.0])


def test_fields_of_robot_yaml() -> None:
    model = make_model("kuka_lwr")
    entry = {"name": "a", "kind": "frame_avoidance", "frame": model.frame_names[-1]}
    entry |= {"stiffness": 100.0, "damping": 20.0, "distance": 0.08, "near": 0.08, "far": 0.14}
    task = make_task(Fields(entry | {"reference": [1.0, 2.0, 3.0]}, "robot.yaml"), model)
    assert task.default_target(model).position == pytest.approx([1.0, 2.0, 3.0])
    with pytest.raises(InvalidValue, match=r"near: 0.2 m given, less than far = 0.14 m"):
        make_task(Fields(entry | {"near": 0.2}, "robot.yaml"), model)
