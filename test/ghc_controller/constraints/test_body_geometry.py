"""Smooth distances of bodies: against coal and finite differences, and at parallel axes."""

from __future__ import annotations

import coal
import numpy as np
import pytest
from model_states import make_model, moved, random_state

from ghc_controller.constraints.bodies.geometry import PENALTY, WORLD, PairGeometry, Placed
from ghc_controller.core import BodyPairs
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.model.rounded_shape import Shape
from ghc_controller.types import Array

STEP = 1e-5  # [s] of finite differences
FRAMES = (3, -1)  # of `frame_names`, early and late in the chain


def _rotation(rng: np.random.Generator) -> Array:
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return turn * np.sign(np.linalg.det(turn))


def _shape(kind: str, rng: np.random.Generator, center: Array) -> Shape:
    if kind == "sphere":
        return Shape(center, np.zeros((3, 0)), 0.05)
    if kind == "capsule":
        half = rng.normal(size=3)
        half *= 0.15 / np.linalg.norm(half)
        return Shape.capsule(center - half, center + half, 0.04)
    return Shape.box(center, rng.uniform(0.1, 0.3, 3), _rotation(rng), 0.01)


def _coal(shape: Shape) -> tuple[coal.CollisionGeometry, coal.Transform3s]:
    """The core of a shape; its radius is left to the caller."""
    place, count = coal.Transform3s.Identity(), shape.axes.shape[1]
    place.setTranslation(shape.center)
    if count == 0:
        return coal.Sphere(1e-9), place
    lengths = np.linalg.norm(shape.axes, axis=0)
    if count == 3:
        place.setRotation(shape.axes / lengths)
        return coal.Box(*(2.0 * lengths)), place
    axis = shape.axes[:, 0] / lengths[0]
    other = np.linalg.qr(np.column_stack([axis, np.eye(3)]))[0]
    turn = np.column_stack([other[:, 1], other[:, 2], axis])
    turn[:, 0] *= np.sign(np.linalg.det(turn))
    place.setRotation(turn)
    return coal.Capsule(1e-9, 2.0 * lengths[0]), place


@pytest.mark.parametrize("first", ["sphere", "capsule", "box"])
@pytest.mark.parametrize("second", ["sphere", "capsule", "box"])
def test_a_distance_is_the_true_one_from_below(first: str, second: str) -> None:
    """Never above coal's, and below it by no more than the penalty explains."""
    rng = np.random.default_rng(3)
    model = make_model("kuka_lwr")
    for _ in range(40):
        shapes = [_shape(first, rng, np.zeros(3)), _shape(second, rng, rng.normal(size=3) * 0.6)]
        geometry = PairGeometry(model, [Placed(one, WORLD) for one in shapes], [(0, 1)])
        found = geometry.near(np.inf)
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        cores = [part for one in shapes for part in _coal(one)]
        true = coal.distance(*cores, request, result)
        if true < 0.02:
            continue
        lengths = sum(float(np.sum(one.axes**2)) for one in shapes)
        below = true - sum(one.radius for one in shapes) - found.distance[0]
        assert -1e-6 <= below <= PENALTY * lengths / true + 1e-6


@pytest.mark.parametrize(
    "kinds", [("capsule", "capsule"), ("sphere", "capsule"), ("box", "capsule"), ("box", "box")]
)
def test_jacobian_and_drift_are_the_second_derivative(kinds: tuple[str, str]) -> None:
    """d(q(t)) along q' = v + x t, between two links and between a link and the world."""
    rng = np.random.default_rng(4)
    compared = 0
    for _ in range(12):
        model = make_model("kuka_lwr")
        links = [model.frame_id(model.frame_names[k]) for k in FRAMES]
        shapes = [
            Placed(_shape(kinds[0], rng, rng.normal(size=3) * 0.2), links[0]),
            Placed(_shape(kinds[1], rng, rng.normal(size=3) * 0.2), links[1]),
            Placed(_shape(kinds[1], rng, rng.normal(size=3)), WORLD),
        ]
        geometry = PairGeometry(model, shapes, [(0, 1), (1, 2)])
        state, x = random_state("kuka_lwr", rng), rng.normal(size=model.nv)
        values, places = [], []
        for t in (-STEP, 0.0, STEP):
            model.update(
                moved("kuka_lwr", state.q, state.v * t + 0.5 * x * t * t), state.v + x * t
            )
            near = geometry.near(np.inf)
            order = np.argsort(near.pairs)
            values.append(near.distance[order])
            places.append(np.abs(near.u[order]) >= 1.0)
        model.update(state.q, state.v)
        near = geometry.near(np.inf)
        motion, order = geometry.motion(near), np.argsort(near.pairs)
        rate = (values[2] - values[0]) / (2.0 * STEP)
        second = (values[2] - 2.0 * values[1] + values[0]) / STEP**2
        claimed = (motion.jacobian @ x + motion.drift)[order]
        for k in range(2):
            if values[1][k] < 0.02 or (places[0][k] != places[2][k]).any():
                continue  # overlapping, or an end of an axis is reached just there
            compared += 1
            assert motion.rate[order][k] == pytest.approx(rate[k], abs=1e-6)
            assert claimed[k] == pytest.approx(second[k], abs=2e-3 * max(1.0, abs(second[k])))
    assert compared > 10


def test_the_gradient_is_continuous_where_capsules_become_parallel() -> None:
    """A capsule turns past another one: its closest point goes from end to end, without a jump."""
    model, half = make_model("kuka_lwr"), np.array([0.15, 0.0, 0.0])
    fixed = Placed(Shape.capsule(-half, half, 0.04), WORLD)
    places = []
    for angle in np.linspace(-0.2, 0.2, 20001):
        end = 0.15 * np.array([np.cos(angle), 0.0, np.sin(angle)])
        center = np.array([0.0, 0.0, 0.12])
        turned = Placed(Shape.capsule(center - end, center + end, 0.04), WORLD)
        places.append(PairGeometry(model, [fixed, turned], [(0, 1)]).near(1.0).u[0])
    assert np.abs(np.diff(places, axis=0)).max() < 0.005
    moved = np.ptp(np.array(places), axis=0)
    assert moved[[0, 3]].min() > 1.9


@pytest.mark.parametrize("kind", ["sphere", "capsule"])
def test_a_large_box_is_seen_where_it_is(kind: str) -> None:
    """A ball, or a link of 0.2 m, about a table, from contact on: at most 1 or 2 mm too near."""
    rng = np.random.default_rng(11)
    model = make_model("kuka_lwr")
    table = Shape.box(np.zeros(3), np.array([1.6, 0.8, 0.04]), np.eye(3))
    worst = 0.0
    for _ in range(300):
        center = rng.uniform(-1.0, 1.0, 3) * [1.0, 0.6, 0.3]
        half = rng.normal(size=3)
        half *= (0.1 if kind == "capsule" else 0.0) / np.linalg.norm(half)
        other = Shape.capsule(center - half, center + half, 0.05)
        geometry = PairGeometry(model, [Placed(one, WORLD) for one in (table, other)], [(0, 1)])
        found = float(geometry.near(np.inf).distance[0])
        cores = [part for one in (table, other) for part in _coal(one)]
        true = coal.distance(*cores, coal.DistanceRequest(), coal.DistanceResult()) - 0.05
        if true > 0.0:
            assert found <= true + 1e-6
            worst = max(worst, true - found)
    assert 1e-5 < worst < (2e-3 if kind == "capsule" else 1e-3)


def test_the_gradient_is_continuous_over_a_large_box() -> None:
    """A capsule tilts over a table, and a table over a table: closest points move, none jumps."""
    model = make_model("kuka_lwr")
    table = Placed(Shape.box(np.zeros(3), np.array([1.6, 0.8, 0.04]), np.eye(3)), WORLD)
    for half, most in (([0.2, 0.0, 0.0], 0.005), ([0.4, 0.3, 0.02], 0.05)):
        places = []
        for angle in np.linspace(-0.1, 0.1, 20001):
            turn = np.array(
                [
                    [np.cos(angle), 0.0, -np.sin(angle)],
                    [0.0, 1.0, 0.0],
                    [np.sin(angle), 0.0, np.cos(angle)],
                ]
            )
            axes = turn @ np.diag(half)[:, : np.count_nonzero(half)]
            other = Placed(Shape(np.array([0.1, 0.05, 0.25]), axes, 0.02), WORLD)
            places.append(PairGeometry(model, [table, other], [(0, 1)]).near(1.0).u[0])
        assert np.abs(np.diff(places, axis=0)).max() < most
        assert np.ptp(np.array(places), axis=0)[0] > 1.9


def test_only_near_pairs_are_returned_nearest_first() -> None:
    model: RobotModel = make_model("kuka_lwr")
    balls = [
        Placed(Shape(np.array([x, 0.0, 0.0]), np.zeros((3, 0)), 0.1), WORLD)
        for x in (0.0, 0.5, 0.3, 2.0)
    ]
    near = PairGeometry(model, balls, [(0, 1), (0, 2), (0, 3)]).near(0.5)
    assert near.pairs.tolist() == [1, 0]
    assert near.distance == pytest.approx([0.1, 0.3])


def test_arrays_of_other_sizes_are_rejected() -> None:
    """As every part of the core does: before anything is read."""
    model = make_model("kuka_lwr")
    frames, pairs = np.array([-1, -1]), np.array([[0, 1]])
    centers, axes, radii = np.zeros((2, 3)), np.zeros((2, 9)), np.ones(2)
    for wrong in (
        (frames, centers[:1], axes, radii, pairs),
        (frames, centers, axes[:, :8].copy(), radii, pairs),
        (frames, centers, axes, radii, np.array([[0, 2]])),
    ):
        with pytest.raises(ValueError, match="expected"):
            BodyPairs(*wrong)
    made = BodyPairs(frames, centers, axes, radii, pairs)
    with pytest.raises(ValueError, match="expected"):
        made.motion(model.core, np.array([1]), np.zeros(1), np.zeros((1, 6)))
    far = BodyPairs(np.array([99, -1]), centers, axes, radii, pairs)
    with pytest.raises(ValueError, match="frames of all shapes"):
        far.near(model.core, 1.0)


@pytest.mark.parametrize("first", ["sphere", "capsule", "box"])
@pytest.mark.parametrize("second", ["capsule", "box"])
def test_overlapping_pairs_are_those_of_coal(first: str, second: str) -> None:
    """Also where the smooth distance is negative and the true one is not."""
    rng = np.random.default_rng(12)
    model, checked, narrow = make_model("kuka_lwr"), 0, 0
    while checked < 60:
        shapes = [_shape(first, rng, np.zeros(3)), _shape(second, rng, rng.normal(size=3) * 0.15)]
        cores = [part for one in shapes for part in _coal(one)]
        true = coal.distance(*cores, coal.DistanceRequest(), coal.DistanceResult())
        true -= sum(one.radius for one in shapes)
        geometry = PairGeometry(model, [Placed(one, WORLD) for one in shapes], [(0, 1)])
        if abs(true) < 2e-5:
            continue
        checked += 1
        smooth = float(geometry.near(np.inf).distance[0])
        narrow += smooth < 0.0 < true
        core = smooth + sum(one.radius for one in shapes)
        if true < 0.0 or core > 0.02:  # nearer the gradient may be too long to be of use
            assert bool(len(geometry.overlapping())) == (true < 0.0)
    assert checked == 60
