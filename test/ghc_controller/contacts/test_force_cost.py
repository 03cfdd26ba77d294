"""The cost on contact forces: its expansion, its limit over the steps, and what it is for."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import on_bent_knees
from scipy.optimize import minimize

from ghc_controller.contacts import Contact, ForceCost
from ghc_controller.controller import Controller
from ghc_controller.hierarchy import Candidate
from ghc_controller.previews.preview import CONTACT_FORCES, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import Robot, load_robot_config
from ghc_controller.schema.reader import Fields
from ghc_controller.settings import Settings
from ghc_controller.types import Array

WEIGHT = 1e-4  # [-] on |f|^2
STANDING = 300.0  # [N] W
SQUARE = [[0.1, 0.04, 0.0], [0.1, -0.04, 0.0], [-0.1, 0.04, 0.0], [-0.1, -0.04, 0.0]]
LEANING = np.array([5.0, -8.0, STANDING, 25.0, 4.0, 1.0])  # [N], [Nm] mostly on the first foot
NORMAL = np.tile([0.0, 0.0, 1.0], 4)


@pytest.fixture(scope="module")
def robot() -> Robot:
    """Only its frames are needed."""
    return load_robot_config(find_robot("kuka_lwr"))


def _feet(robot: Robot, count: int) -> list[Contact]:
    return [
        Contact.from_config(
            Fields(
                {"name": f"foot_{k}", "frame": "tool", "points": SQUARE, "normal": [0, 0, 1]},
                "test",
            ),
            robot.model,
        )
        for k in range(count)
    ]


def _true_cost(force: Array) -> float:
    """Half of weight (|f|^2 + W |u|^2 / F), summed over feet of twelve forces."""
    total = 0.0
    for f in force.reshape(-1, 12):
        load = float(NORMAL @ f)
        uneven = f - NORMAL * load / 4.0
        total += 0.5 * WEIGHT * float(f @ f + STANDING * uneven @ uneven / load)
    return total


def _standing_force(rng: np.random.Generator) -> Array:
    """(12,) with a clear normal force at each point."""
    force = rng.normal(size=12)
    force[2::3] = rng.uniform(5.0, 40.0, size=4)
    return force


@pytest.mark.parametrize("seed", range(5))
def test_the_expansion_has_gradient_and_curvature_of_the_cost(robot: Robot, seed: int) -> None:
    """H (f - f_0) and H at the last forces against finite differences."""
    rng = np.random.default_rng(seed)
    last = _standing_force(rng)
    cost = ForceCost(_feet(robot, 1), STANDING)
    cost.remember(0, last)
    cost.advance()
    center, factor = cost.of(np.arange(1), ReferenceSchedule([]), 0.0)
    hessian = np.linalg.inv(factor @ factor.T)
    step = 1e-2  # [N]
    for direction in rng.normal(size=(6, 12)):
        ahead, behind = (_true_cost(last + s * step * direction) for s in (1.0, -1.0))
        slope = (ahead - behind) / (2.0 * step)
        bend = (ahead - 2.0 * _true_cost(last) + behind) / step**2
        assert direction @ hessian @ (last - center) == pytest.approx(slope, rel=1e-5, abs=1e-7)
        assert direction @ hessian @ direction == pytest.approx(bend, rel=1e-3)


def test_over_the_steps_the_forces_are_those_of_the_least_cost(robot: Robot) -> None:
    """Newton's steps under a balance of forces and moments, against a general optimiser."""
    balance = _balance()
    force = _settled(robot, STANDING)
    best = minimize(
        lambda f: 1e4 * _true_cost(f),
        np.tile([0.0, 0.0, STANDING / 8.0], 8),
        constraints={"type": "eq", "fun": lambda f: balance @ f - LEANING},
        options={"maxiter": 500, "ftol": 1e-12},
    )
    assert best.success
    assert np.allclose(balance @ force, LEANING)
    assert _true_cost(force) == pytest.approx(_true_cost(best.x), rel=1e-6)
    assert np.allclose(force, best.x, atol=0.05)


def test_a_light_foot_is_used_like_the_heavy_one(robot: Robot) -> None:
    """Where |f|^2 alone would put its center of pressure beside the sole."""
    reach = 0.04  # [m] of the sole to the side
    plain, shared = (_sideways(_settled(robot, weight)) for weight in (0.0, STANDING))
    assert abs(plain[1]) > reach
    assert abs(shared[1]) < 0.5 * reach
    assert shared[1] == pytest.approx(shared[0], abs=0.1 * reach)


def test_without_a_weight_it_is_the_square_of_the_forces(robot: Robot) -> None:
    cost = ForceCost(_feet(robot, 1), 0.0)
    cost.remember(0, _standing_force(np.random.default_rng(0)))
    cost.advance()
    center, factor = cost.of(np.arange(1), ReferenceSchedule([]), 0.0)
    assert np.allclose(center, 0.0)
    assert np.allclose(factor @ factor.T, np.eye(12) / WEIGHT)


def test_reset_forgets(robot: Robot) -> None:
    cost, fresh = (ForceCost(_feet(robot, 1), STANDING) for _ in range(2))
    cost.remember(0, _standing_force(np.random.default_rng(0)))
    cost.advance()
    cost.reset()
    for left, right in zip(
        cost.of(np.arange(1), ReferenceSchedule([]), 0.0),
        fresh.of(np.arange(1), ReferenceSchedule([]), 0.0),
        strict=True,
    ):
        assert np.array_equal(left, right)


def test_each_candidate_has_its_own_expansion(robot: Robot) -> None:
    """About its own forces; one that enters begins at those of the blend. Seed 3.

    What is left of a mixture goes on from its own, and a time that is asked again from the same.
    """
    rng = np.random.default_rng(3)
    old, new, blend = (_standing_force(rng) for _ in range(3))
    first, second = (Candidate(np.full((2, 2), value), 0.5) for value in (0.0, 1.0))
    cost = ForceCost(_feet(robot, 1), STANDING)

    def center(candidate: str = "") -> Array:
        keys = {"": (), "first": cost.keys[:1], "second": cost.keys[1:]}[candidate]
        return cost.of(np.arange(1), ReferenceSchedule([]), 0.0, *keys).center

    about = {}
    for name, force in (("old", old), ("new", new), ("blend", blend)):
        cost.remember(0, force)
        cost.advance()
        about[name] = center()
    cost.begin(1.0, (first, second))
    assert cost.entering() == [0, 1]
    assert np.array_equal(center("first"), about["blend"])
    assert np.array_equal(center("second"), about["blend"])
    for key, force in zip(cost.keys, (old, new), strict=True):
        cost.remember(0, force, key)
    for time in (2.0, 2.0):
        cost.begin(time, (first, second))
        assert cost.entering() == []
        assert np.array_equal(center("first"), about["old"])
        assert np.array_equal(center("second"), about["new"])
        assert np.array_equal(center(), about["blend"])
    cost.begin(3.0, (second,))
    assert not cost.keys
    assert np.array_equal(center(), about["new"])
    cost.forget_candidates()
    cost.begin(4.0, (second,))
    assert np.array_equal(center(), about["blend"])


def test_on_a_fixed_base_the_candidates_share_their_cost(robot: Robot) -> None:
    cost = ForceCost(_feet(robot, 1), 0.0)
    cost.begin(0.0, [Candidate(np.full((2, 2), value), 0.5) for value in (0.0, 1.0)])
    assert not cost.keys
    assert cost.entering() == []


@pytest.fixture(scope="module")
def standing() -> Controller:
    """iCub with its knees bent, on both soles."""
    return Controller.for_robot("icub", Settings(torque_rate_limit=0.0))


def _lean_on_the_palm(controller: Controller) -> None:
    """From now on the right palm carries as well."""
    names = controller.contacts.names
    active = controller.force_bounds.at(0.0).active
    on = tuple(now or name == "right_palm" for now, name in zip(active, names, strict=True))
    upper = np.full((len(names), 2), 500.0)
    status, ends = (PreviewStatus.RAW,) * len(names), (False,) * len(names)
    controller.force_bounds.follow(
        Preview(
            CONTACT_FORCES, 0.0, 1.0, names, np.zeros_like(upper), upper, on, status, ends, False
        )
    )


def test_the_first_step_is_not_felt_by_the_next(standing: Controller) -> None:
    """It knows no forces and solves again; so does a step in which a contact comes on."""
    standing.reset()
    first, second = (
        standing.step(on_bent_knees(standing.model, 1e-3 * k)).torque for k in range(2)
    )
    assert np.allclose(first, second, atol=1e-4)
    _lean_on_the_palm(standing)
    third, fourth = (standing.step(on_bent_knees(standing.model, 1e-3 * k)).torque for k in (2, 3))
    assert np.abs(third - second).max() > 1.0  # one more hand carries
    assert np.allclose(third, fourth, atol=5e-3)


def test_a_first_step_that_is_asked_again_is_a_first_step_still(standing: Controller) -> None:
    """As in lockstep, where the first state is repeated until everything has been said."""
    standing.reset()
    alone = standing.step(on_bent_knees(standing.model, 0.0)).torque
    _lean_on_the_palm(standing)
    again, after = (
        standing.step(on_bent_knees(standing.model, 1e-3 * k)).torque for k in range(2)
    )
    assert np.abs(again - alone).max() > 1.0
    assert np.allclose(again, after, atol=5e-3)


@pytest.mark.parametrize("steps", [1, 2, 5])
def test_a_repeated_time_changes_nothing(standing: Controller, steps: int) -> None:
    """Whoever asks again at the same stamp gets the same torque, and the next one is the same."""
    torques: list[Array] = []
    for repeats in (1, 3):
        standing.reset()
        for k in range(steps):
            for _ in range(repeats):
                answer = standing.step(on_bent_knees(standing.model, 1e-3 * k))
        torques.append(answer.torque)
    assert np.allclose(torques[0], torques[1], rtol=0.0, atol=1e-12)


def _balance() -> Array:
    """(6, 24) force and moment of two feet beside each other."""
    arms = np.array([[0.0, 0.1, 0.0], [0.0, -0.1, 0.0]])
    points = np.array(SQUARE)
    return np.hstack([np.vstack([np.eye(3), _cross(arm + p)]) for arm in arms for p in points])


def _settled(robot: Robot, weight_force: float) -> Array:
    """(24,) forces of two feet that hold LEANING, after many steps."""
    balance, cost = _balance(), ForceCost(_feet(robot, 2), weight_force)
    force = np.zeros(24)
    for time in range(30):
        cost.begin(float(time))
        center, factor = cost.of(np.arange(2), ReferenceSchedule([]), float(time))
        metric = factor @ factor.T
        gap = LEANING - balance @ center
        force = center + metric @ balance.T @ np.linalg.solve(balance @ metric @ balance.T, gap)
        for foot in range(2):
            cost.remember(foot, force[12 * foot : 12 * foot + 12])
    return force


def _sideways(force: Array) -> list[float]:
    """Center of pressure [m] of each foot along y, from its middle."""
    normal = force[2::3].reshape(2, 4)
    return [float(f @ np.array(SQUARE)[:, 1] / f.sum()) for f in normal]


def _cross(arm: Array) -> Array:
    x, y, z = arm
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
