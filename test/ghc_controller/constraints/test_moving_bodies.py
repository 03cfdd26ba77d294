"""Obstacles that move: derivatives of their distances, and an arm that makes way for a ball."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from model_states import make_model, moved, random_state

import ghc_controller as ghc
from ghc_controller.constraints import Tick
from ghc_controller.constraints.bodies.geometry import WORLD, PairGeometry, Placed
from ghc_controller.constraints.registry import make_constraint
from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.model.rounded_shape import Shape
from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.preview import Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.robot.library import load_robot
from ghc_controller.schema.reader import Fields
from ghc_controller.types import Array, RobotState
from ghc_sim_bridge.simulation.simulator import Simulator

STEP = 1e-5  # [s] of finite differences
PLAN, POINTS = 0.01, 10  # [s] between plans, steps of each
MARGIN = 0.02  # [m]


def _shape(kind: str, rng: np.random.Generator, center: Array) -> Shape:
    half = 0.1 * rng.normal(size=3)
    if kind == "sphere":
        return Shape(center, np.zeros((3, 0)), 0.05)
    if kind == "capsule":
        return Shape.capsule(center - half, center + half, 0.04)
    return Shape.box(center, np.abs(half) + 0.1, np.eye(3), 0.01)


@pytest.mark.parametrize(
    ("body", "obstacle"), [("capsule", "sphere"), ("capsule", "capsule"), ("box", "capsule")]
)
@pytest.mark.parametrize("obstacle_first", [False, True])
def test_rate_and_drift_are_those_of_both_motions(
    body: str, obstacle: str, obstacle_first: bool
) -> None:
    """d(q(t), o(t)) along q' = v + x t and o' = w + a t against finite differences."""
    rng, compared = np.random.default_rng(5), 0
    for _ in range(12):
        model = make_model("kuka_lwr")
        link = model.frame_id(model.frame_names[-1])
        shapes = [
            Placed(_shape(body, rng, rng.normal(size=3) * 0.2), link),
            Placed(_shape(obstacle, rng, rng.normal(size=3)), WORLD),
        ]
        geometry = PairGeometry(model, shapes, [(1, 0) if obstacle_first else (0, 1)])
        state, x = random_state("kuka_lwr", rng), rng.normal(size=model.nv)
        way, w, a = rng.normal(size=(3, 3)) * [[0.1], [0.5], [2.0]]
        values, places = [], []
        for t in (-STEP, STEP, 0.0):
            q = moved("kuka_lwr", state.q, state.v * t + 0.5 * x * t * t)
            model.update(q, state.v + x * t)
            geometry.move({1: np.array([way + w * t + 0.5 * a * t * t, w + a * t, a])})
            near = geometry.near(np.inf)
            values.append(float(near.distance[0]))
            places.append(np.abs(near.u[0]) >= 1.0)
        motion = geometry.motion(near)
        rate = (values[1] - values[0]) / (2.0 * STEP)
        second = (values[1] - 2.0 * values[2] + values[0]) / STEP**2
        if values[2] < 0.02 or (places[0] != places[1]).any():
            continue  # overlapping, or an end of an axis is reached just there
        compared += 1
        assert motion.rate[0] == pytest.approx(rate, abs=1e-6)
        claimed = float((motion.jacobian @ x + motion.drift)[0])
        assert claimed == pytest.approx(second, abs=2e-3 * max(1.0, abs(second)))
    assert compared > 5


def _plan(start: float, place: Array, velocity: Array) -> Preview:
    """A ball that keeps its velocity."""
    state = np.array([place, velocity, np.zeros(3)])
    up = np.array([0.0, 0.0, 1.0])
    still, status = np.zeros((POINTS, 3)), PreviewStatus.SMOOTHED
    ball = PlannedMotion("ball", "", 0.0, up, state, still, status)
    return Preview.of_motions(start, PLAN, POINTS, (ball,))


def _least(ball: dict[str, Any], velocity: Array, known: bool) -> float:
    """Least distance over its margin [m] while a ball passes the arm; plans with its velocity?"""
    arm = load_robot("kuka_lwr")
    bodies = {
        "fore": {"frame": "link_4", "from": [0, 0, 0], "to": [0, 0, 0.19], "radius": 0.08},
        "hand": {"frame": "tool", "at": [0, 0, 0], "radius": 0.05},
    }
    entry = {"name": "bodies", "kind": "body_distance", "bodies": bodies}
    entry |= {"obstacles": {"ball": ball}, "margins": {"all": {"margin": MARGIN}}}
    robot = ghc.Robot.from_urdf(
        arm.urdf,
        tasks=[ghc.posture("posture", stiffness=100.0, damping=20.0)],
        hierarchy="posture",
        constraints=[entry],
    )
    simulator = Simulator("kuka_lwr", joint_names=robot.model.joint_names)
    controller = ghc.Controller(robot)
    controller.start(simulator.state())
    constraint = controller.constraints.one_of(BodyDistance)
    start, least = simulator.frame_position("tool") - 1.0 * velocity, np.inf
    for tick in range(1300):
        time = simulator.time
        if tick % round(1e3 * PLAN) == 0:
            place = start + velocity * time
            left_out = controller.follow(_plan(time, place, velocity if known else 0.0 * velocity))
            assert left_out == ()
        result = controller.step(simulator.state())
        assert result.status is not ghc.StepStatus.FALLBACK
        simulator.step(result.torque)
        if tick % 5 == 0:
            room = constraint.distances() - constraint.pair_margins(time)
            least = min(least, float(room.min()))
    return least


def test_an_arm_makes_way_for_a_ball_whose_velocity_is_planned() -> None:
    """It comes at the hand with 0.2 m/s; with places alone the margin is not kept."""
    ball, velocity = {"at": [2.0, 2.0, 2.0], "radius": 0.06, "moves": True}, [0.0, 0.2, 0.0]
    assert -1e-3 < _least(ball, np.array(velocity), True) < 5e-3
    assert _least(ball, np.array(velocity), False) < -2e-3


@pytest.mark.parametrize("moves", [False, True])
def test_only_an_obstacle_that_moves_follows_plans_and_a_reset_brings_it_back(moves: bool) -> None:
    model = load_robot("kuka_lwr").model
    entry = {"name": "bodies", "kind": "body_distance", "margins": {"all": {"margin": MARGIN}}}
    entry["bodies"] = {"hand": {"frame": "tool", "at": [0, 0, 0], "radius": 0.05}}
    entry["obstacles"] = {"ball": {"at": [3.0, 0.0, 0.0], "radius": 0.1, "moves": moves}}
    made = make_constraint(Fields(entry, "robot.yaml"), model)
    assert isinstance(made, BodyDistance)
    state = RobotState(0.0, np.zeros(7), np.zeros(7))
    tick = Tick(model, model.update(state.q, state.v), state, None, 1e-3)
    made.rows(tick)
    first = made.distances()
    made.follow_obstacles(_plan(0.0, np.array([1.0, 0.0, 0.0]), np.zeros(3)))
    made.rows(tick)
    assert (made.distances() < first - 0.5).all() == moves
    made.reset()
    made.rows(tick)
    assert made.distances() == pytest.approx(first, abs=1e-12)
