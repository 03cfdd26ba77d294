"""A configuration is a value: it equals the model at its state, and nothing changes it later."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import ROBOTS, make_model, random_state

import ghc_controller as ghc
from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.model.configuration import Configuration


@pytest.mark.parametrize("robot", ROBOTS)
def test_it_is_the_model_at_its_state_and_stays_so(robot: str) -> None:
    """Equal to RobotModel to the last bit, after 3 later states too. Seed 4."""
    model, rng = make_model(robot), np.random.default_rng(4)
    states = [random_state(robot, rng) for _ in range(4)]
    first = Configuration.of(model, states[0].q, states[0].v)
    values = [first, *(first.update(state.q, state.v) for state in states[1:])]
    for state, value in zip(states, values, strict=True):
        model.update(state.q, state.v)
        assert np.array_equal(value.q, state.q) and np.array_equal(value.v, state.v)
        assert np.array_equal(value.dynamics.mass_matrix, model.dynamics.mass_matrix)
        assert np.array_equal(value.dynamics.bias, model.dynamics.bias)
        assert np.array_equal(value.gravity, model.gravity())
        assert np.array_equal(value.center_of_mass, model.center_of_mass())
        assert np.array_equal(value.center_of_mass_jacobian, model.center_of_mass_jacobian())
        for name in model.frame_names:
            terms = model.frame(model.frame_id(name))
            for field in ("position", "rotation", "jacobian", "velocity", "drift"):
                assert np.array_equal(getattr(value.frame(name), field), getattr(terms, field))


def test_moving_goes_along_the_jacobian() -> None:
    """p(q + dt v) - p(q - dt v) = 2 dt J v to 1e-8, every link. Seed 5."""
    state = random_state("humanoid", np.random.default_rng(5))
    here = Configuration.of(make_model("humanoid"), state.q, state.v)
    ahead, behind = here.moved(state.v, 1e-6), here.moved(state.v, -1e-6)
    for name, terms in here.frames.items():
        rate = (ahead.frame(name).position - behind.frame(name).position) / 2e-6
        assert np.abs(rate - terms.jacobian[:3] @ state.v).max() < 1e-8
        assert np.allclose(terms.velocity, terms.jacobian @ state.v, rtol=0.0, atol=1e-12)


def test_nothing_of_it_can_be_written() -> None:
    robot = ghc.load_robot("kuka_lwr")
    q = np.full(7, 0.3)
    here = robot.at(q)
    q[:] = 0.0
    assert np.array_equal(here.q, np.full(7, 0.3)) and not here.v.any()
    arrays = [here.q, here.v, here.gravity, here.dynamics.mass_matrix, here.frame("tool").jacobian]
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(AttributeError):
        here.q = q  # type: ignore[misc]
    with pytest.raises(TypeError):
        here.frames["tool"] = here.frame("elbow")  # type: ignore[index]


def test_limits_and_mistakes_are_named() -> None:
    robot = ghc.load_robot("kuka_lwr")
    upper = robot.model.position_upper
    assert robot.at(upper).outside_limits == ()
    names = robot.model.joint_names
    assert robot.at(upper + [0, 0.01, 0, 0, 0, 0, 0.01]).outside_limits == (names[1], names[6])
    with pytest.raises(UnknownName, match=r"frame 'toll'.*tool"):
        robot.at(upper).frame("toll")
    for q, v in ((np.zeros(6), None), (np.zeros(7), np.zeros(8))):
        with pytest.raises(WrongSize):
            robot.at(q, v)
    with pytest.raises(WrongSize, match="velocity"):
        robot.at(upper).moved(np.zeros(6))
    with pytest.raises(InvalidValue, match="not finite"):
        robot.at(np.full(7, np.nan))
