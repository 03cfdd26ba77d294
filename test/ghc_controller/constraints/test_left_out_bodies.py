"""Pairs of bodies that overlap where a run begins, and what becomes of them."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

from ghc_controller.constraints import Tick
from ghc_controller.constraints.bodies.left_out import FADE
from ghc_controller.constraints.registry import make_constraint
from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.library import load_robot
from ghc_controller.schema.reader import Fields
from ghc_controller.types import Array, RobotState

DT, MARGIN = 1e-3, 0.02  # [s], [m]
Q = np.array([0.3, 0.4, 0.1, 1.0, -0.4, -0.9, 0.2])  # [rad]


def _above(height: float) -> tuple[BodyDistance, RobotModel]:
    """A hand at Q, so far [m] above a table."""
    model = load_robot("kuka_lwr").model
    tool = model.frame_id("tool")
    model.update(Q, np.zeros(7))
    center = model.frame_position(tool) - [0.0, 0.0, 0.05 + height + 0.05]
    entry: dict[str, Any] = {
        "name": "bodies",
        "kind": "body_distance",
        "bodies": {"hand": {"frame": "tool", "at": [0, 0, 0], "radius": 0.05}},
        "obstacles": {"table": {"at": center.tolist(), "size": [0.3, 0.3, 0.1]}},
        "margins": {"all": {"margin": MARGIN}},
    }
    made = make_constraint(Fields(entry, "robot.yaml"), model)
    assert isinstance(made, BodyDistance)
    return made, model


def _lifted(model: RobotModel, by: float) -> Array:
    """Configuration at which the tool of Q is `by` [m] higher."""
    q, tool = Q.copy(), model.frame_id("tool")
    model.update(q, np.zeros(7))
    goal = model.frame_position(tool) + [0.0, 0.0, by]
    for _ in range(20):
        model.update(q, np.zeros(7))
        left = goal - model.frame_position(tool)
        q = q + np.linalg.pinv(model.frame_jacobian(tool)[:3]) @ left
    return q


def _lower(made: BodyDistance, model: RobotModel, q: Array, time: float) -> float | None:
    """Lower bound [m/s^2] of the row of hand and table at rest; None without one."""
    state = RobotState(time, q, np.zeros(7))
    rows = made.rows(Tick(model, model.update(q, state.v), state, None, DT))
    if rows is None:
        return None
    assert rows.names == ("bodies.hand-table",)
    return float(rows.lower[0])


def test_an_arm_that_restarts_in_touch_gets_its_pair_back() -> None:
    """Once it is above the margin, and then for good, also where it comes nearer again."""
    made, model = _above(-0.01)
    with pytest.warns(UserWarning, match="until they are above their margins: hand-table"):
        assert _lower(made, model, Q, 0.0) is None
    assert made.touching
    assert _lower(made, model, _lifted(model, 0.5 * MARGIN), 0.1) is None  # apart, too near
    assert _lower(made, model, _lifted(model, 0.015 + MARGIN), 0.2) is None  # it fades in
    assert not tuple(made.touching)
    above, _ = _above(0.005 + MARGIN)
    q = _lifted(model, 0.015 + MARGIN)
    expected = _lower(above, load_robot("kuka_lwr").model, Q, 0.0)
    assert _lower(made, model, q, 0.2 + FADE) == pytest.approx(expected, abs=1e-6)
    within = _lower(made, model, _lifted(model, 0.5 * MARGIN), 0.3 + FADE)
    assert within is not None
    assert within > 0.0  # back above the margin


def test_a_pair_that_comes_back_makes_no_jump() -> None:
    """At rest at one place, the bound rises continuously and never beyond its own."""
    made, model = _above(-0.01)
    with pytest.warns(UserWarning, match="hand-table"):
        _lower(made, model, Q, 0.0)
    q = _lifted(model, 0.011 + MARGIN)
    found = [_lower(made, model, q, 0.1 + k * DT) for k in range(1000)]
    given = [one for one in found if one is not None]
    assert found[0] is None
    assert given[0] < -500.0  # [m/s^2] it allows everything
    assert (np.diff(given) >= 0.0).all()
    active = [one for one in given if one > -10.0]
    assert np.diff(active).max() < 0.1  # [m/s^2] in a millisecond
    assert given[-1] == given[-2]


def test_a_reset_leaves_out_what_overlaps_then() -> None:
    made, model = _above(-0.01)
    with pytest.warns(UserWarning, match="hand-table"):
        _lower(made, model, Q, 0.0)
    _lower(made, model, _lifted(model, 0.1), 0.1)
    made.reset()
    with pytest.warns(UserWarning, match="hand-table"):
        assert _lower(made, model, Q, 0.2) is None


def test_two_bodies_of_a_robot_stay_left_out() -> None:
    """Their shapes are too large for them: the pose of the start must stay possible."""
    model = load_robot("kuka_lwr").model
    entry: dict[str, Any] = {
        "name": "bodies",
        "kind": "body_distance",
        "bodies": {
            "upper": {"frame": "link_2", "at": [0, 0, 0], "radius": 0.25},
            "hand": {"frame": "tool", "at": [0, 0, 0], "radius": 0.25},
        },
        "margins": {"all": {"margin": 0.0}},
    }
    made = make_constraint(Fields(entry, "robot.yaml"), model)
    assert isinstance(made, BodyDistance)
    bent, straight = np.array([0.0, 0.5, 0, 2.0, 0, 1.9, 0]), np.zeros(7)
    with pytest.warns(UserWarning, match="list them under 'excluded'"):
        assert _lower(made, model, bent, 0.0) is None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert _lower(made, model, straight, 1.0) is None
        assert made.distances()[0] > 0.1
        assert _lower(made, model, bent, 2.0) is None
    assert made.touching == (("upper", "hand"),)
