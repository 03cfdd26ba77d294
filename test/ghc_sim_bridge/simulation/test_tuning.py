"""Gains, weights, limits and formulation change while the arm moves, without a jump of torque."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ghc_controller.constraints import JointVelocityLimit
from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError, InvalidValue, UnknownName
from ghc_controller.formulations import FORMULATIONS
from ghc_controller.hierarchy import PriorityMatrix, Transition
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.robot.library import load_robot
from ghc_controller.settings import Settings
from ghc_controller.types import Array
from ghc_sim_bridge.simulation.simulator import Simulator

DT = 1e-3  # [s]
CHANGE, END = 0.4, 1.6  # [s]
MOST_BY_GAINS, MOST_BY_FORMULATION = 20.0, 50.0  # [Nm/s] above the run without the change
ORDER = "end_effector > elbow > posture"


def _controller() -> Controller:
    return Controller.for_robot("kuka_lwr", Settings.of(hierarchy=ORDER))


def _gains(controller: Controller, factor: float) -> dict[str, Any]:
    """Every gain and w, times a factor."""
    changed: dict[str, Any] = {
        f"tasks.{task.name}.{gain}": (factor * getattr(task, gain)).tolist()
        for task in controller.robot.tasks
        for gain in ("stiffness", "damping")
    }
    return changed | {"regularization": factor * 0.01, "velocity_damping": factor * 20.0}


def _circle(controller: Controller) -> ReferenceTrajectory:
    """A circle of 5 cm from rest to rest at the start of the arm; the elbow cannot stay."""
    task = controller.references.task("end_effector")
    start = controller.references.targets(0.0)[0].position
    time = np.linspace(0.0, END, 161)
    s = time / END
    angle = 2.0 * np.pi * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    rate = 60.0 * np.pi * s**2 * (1.0 - s) ** 2 / END
    change = 120.0 * np.pi * s * (1.0 - s) * (1.0 - 2.0 * s) / END**2
    sine, cosine, zero = np.sin(angle), np.cos(angle), 0.0 * angle
    tangent = np.stack([sine, cosine, zero], axis=1)
    inward = np.stack([cosine, -sine, zero], axis=1)
    position = start + 0.05 * np.stack([1.0 - cosine, sine, zero], axis=1)
    velocity = 0.05 * tangent * rate[:, None]
    acceleration = 0.05 * (tangent * change[:, None] + inward * rate[:, None] ** 2)
    return ReferenceTrajectory.for_task(task, time, position, velocity, acceleration, None)


def _torques(values: Mapping[str, Any] | None) -> tuple[Array, Controller]:
    """(T, 7) torques of a run in which `values` change at CHANGE."""
    simulator, controller = Simulator("kuka_lwr", control_dt=DT, physics_dt=DT), _controller()
    controller.start(simulator.state())
    controller.add_reference(_circle(controller))
    torques = []
    for tick in range(round(END / DT)):
        if values is not None and tick == round(CHANGE / DT):
            controller.tune(values)
        result = controller.step(simulator.state())
        simulator.step(result.torque)
        torques.append(result.torque)
    return np.array(torques), controller


def _rates(torques: Array) -> Array:
    """(T',) [Nm/s] largest torque rate of each period from the change on."""
    first = round(CHANGE / DT) - 1
    rates: Array = np.abs(np.diff(torques, axis=0)).max(axis=1)[first:] / DT
    return rates


@pytest.fixture(scope="module")
def unchanged() -> Array:
    return _rates(_torques(None)[0])


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_every_gain_and_w_by_a_factor_of_two(unchanged: Array, factor: float) -> None:
    wanted = _gains(_controller(), factor)
    torques, controller = _torques(wanted)
    assert (_rates(torques) - unchanged).max() <= MOST_BY_GAINS
    assert not controller.tuning.moves
    assert controller.formulation.settings.regularization == factor * 0.01
    for own, task in zip(controller.stack.tasks, controller.robot.tasks, strict=True):
        np.testing.assert_array_equal(own.stiffness, factor * task.stiffness)
    assert not np.allclose(torques[-1], _torques(None)[0][-1], atol=1e-3)


def test_another_formulation(unchanged: Array) -> None:
    torques, controller = _torques({"formulation": "balanced"})
    assert (_rates(torques) - unchanged).max() <= MOST_BY_FORMULATION
    assert controller.formulation.name == controller.settings.formulation == "balanced"


def test_limits_move_to_their_new_value_and_hold_after_a_reset() -> None:
    simulator, controller = Simulator("kuka_lwr"), _controller()
    controller.start(simulator.state())
    controller.step(simulator.state())
    controller.tune({"velocity_limit": 0.4, "torque_rate_limit": 300.0}, duration=10.0)
    for tick in range(3):
        controller.step(simulator.state())
        simulator.step(controller.brake(simulator.state()))
        before = controller.gate.torque_step_limit[0]
        assert tick == 0 or before < controller.robot.torque_rate * DT
    controller.reset()
    np.testing.assert_allclose(controller.gate.torque_step_limit, 0.3)
    controller.tune({"velocity_limit": 0.0})  # of the robot again, at once before the first step
    velocity = controller.constraints.one_of(JointVelocityLimit)
    np.testing.assert_array_equal(velocity.limit, controller.model.limits.velocity)


@pytest.mark.parametrize(
    ("values", "kind", "words"),
    [
        ({"tasks.end_effector.stiffness": -1.0}, InvalidValue, "numbers >= 0 expected"),
        ({"tasks.elbow.damping": [1.0, 2.0]}, InvalidValue, "one number or 3 expected"),
        ({"regularization": 0.0}, GhcError, "a number above 0 expected"),
        ({"regularisation": 1.0}, UnknownName, "regularization"),
        ({"control_dt": 0.002}, InvalidValue, "it holds from the start on"),
        ({"second_order": True}, InvalidValue, "it holds from the start on"),
        ({"torque_bound": 50.0}, InvalidValue, "it is off since the start"),
        ({"torque_rate_limit": 0.0}, InvalidValue, "it cannot be switched off while running"),
        ({"formulation": "cascad"}, UnknownName, "cascade"),
    ],
)
def test_what_cannot_change_is_refused_and_changes_nothing(
    values: dict[str, Any], kind: type[GhcError], words: str
) -> None:
    controller = _controller()
    controller.observe(Simulator("kuka_lwr").state())
    before = controller.settings
    with pytest.raises(kind) as caught:
        controller.tune({"velocity_damping": 10.0} | values)
    assert words in str(caught.value)
    assert next(iter(values)) in str(caught.value) or kind is UnknownName
    assert controller.settings == before
    assert controller.formulation.settings.velocity_damping == 20.0


def test_one_change_of_formulation_at_a_time_and_none_beside_a_paced_ramp() -> None:
    simulator, controller = Simulator("kuka_lwr"), _controller()
    controller.start(simulator.state())
    controller.step(simulator.state())
    controller.tune({"formulation": "hqp"})
    with pytest.raises(InvalidValue, match="a change of formulation is under way"):
        controller.tune({"formulation": "ghc"})
    controller.tuning.finish()
    names = controller.robot.task_names
    no_order = PriorityMatrix(names, np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 1.0, 0.0]]))
    controller.add_transition(Transition(no_order, 1.0, 1.0), 0.0)
    with pytest.raises(InvalidValue, match="'rhp_hqp' knows orders only"):
        controller.tune({"formulation": "rhp_hqp"})
    controller.tune({"formulation": "cascade"})
    controller.tuning.finish()
    controller.change_hierarchy("elbow > posture", duration=1.0, torque_rate=5.0)
    with pytest.raises(InvalidValue, match="a transition with a torque rate"):
        controller.tune({"formulation": "ghc"})


def _moving() -> Controller:
    """A controller that made a step, so that changes take their time."""
    simulator, controller = Simulator("kuka_lwr", control_dt=DT, physics_dt=DT), _controller()
    controller.start(simulator.state())
    controller.step(simulator.state())
    return controller


def test_a_gain_is_checked_with_the_goal_of_its_partner_on_the_way() -> None:
    controller = _moving()
    controller.tune({"tasks.posture.damping": 1500.0})  # 2 d dt = 3 of the 4 that are possible
    with pytest.raises(InvalidValue, match="diverges"):
        controller.tune({"tasks.posture.stiffness": 2e6})  # k dt^2 = 2
    controller.tuning.finish()
    with pytest.raises(InvalidValue, match="diverges"):
        controller.tune({"tasks.posture.stiffness": 2e6})


def test_a_gain_that_still_falls_counts_with_what_it_is() -> None:
    controller = _moving()
    controller.tune({"tasks.posture.damping": 1500.0})
    controller.tuning.finish()
    controller.tune({"tasks.posture.damping": 10.0})
    with pytest.raises(InvalidValue, match="diverges"):  # it would rise before that one falls
        controller.tune({"tasks.posture.stiffness": 2e6}, 0.0)


@pytest.mark.parametrize("value", ["fast", ["1", "x"], None, b"x", [[1.0], [2.0, 3.0]]])
def test_a_gain_that_is_no_number_is_rejected(value: Any) -> None:
    controller = _moving()
    with pytest.raises(GhcError, match=r"tasks\.posture\.stiffness"):
        controller.tune({"tasks.posture.stiffness": value})


def test_a_velocity_damping_that_the_period_cannot_carry_is_rejected() -> None:
    """v+ = (1 - kd dt) v of motions that no task claims: with more the arm shakes at rest."""
    controller = _moving()
    controller.tune({"velocity_damping": 1.9 / DT})
    with pytest.raises(InvalidValue, match=r"velocity_damping: 2500 given.*diverge"):
        controller.tune({"velocity_damping": 2.5 / DT})
    with pytest.raises(InvalidValue, match=r"velocity_damping: 2500 given.*diverge"):
        Controller.for_robot("kuka_lwr", Settings.of(velocity_damping=2.5 / DT, control_dt=DT))


def test_an_obstacle_horizon_that_the_period_cannot_carry_is_rejected() -> None:
    """A row in force is a task with 2 / h^2 and 2 / h: with a shorter h the arm runs away."""
    controller = _moving()
    controller.tune({"obstacle_horizon": 1.4 * DT})
    with pytest.raises(InvalidValue, match=r"obstacle_horizon: 0\.0013 given.*diverge"):
        controller.tune({"obstacle_horizon": 1.3 * DT})
    with pytest.raises(InvalidValue, match=r"obstacle_horizon: 0\.0013 given.*diverge"):
        Controller.for_robot("kuka_lwr", Settings.of(obstacle_horizon=1.3 * DT, control_dt=DT))


@pytest.mark.parametrize("name", ["regularization", "velocity_damping", "torque_weight"])
@pytest.mark.parametrize("formulation", sorted(FORMULATIONS.usable()))
def test_a_weight_reaches_every_formulation(formulation: str, name: str) -> None:
    """After its way the torques are those of a controller that was made with it."""
    given = {"formulation": formulation, "torque_regularization": "bias"}
    value = 3.0 * getattr(Settings.of(**given).optimization, name)
    settings = [Settings.of(**given), Settings.of(**given, **{name: value})]
    tuned, made = (Controller.for_robot("kuka_lwr", one) for one in settings)
    rest = Simulator("kuka_lwr").state()
    for step in range(3):
        state = replace(rest, time=step * DT, v=np.full(7, 0.3))
        torques = []
        for controller in (tuned, made):
            if step == 0:
                controller.start(state)
                hand = controller.robot.tasks[0]
                controller.set_reference(hand.name, hand.current(controller.model) + 0.02)
            elif step == 1 and controller is tuned:
                controller.tune({name: value}, 0.0)
            torques.append(controller.step(state).solution.torque)
    np.testing.assert_allclose(torques[0], torques[1], rtol=0.0, atol=1e-6)


def test_a_limit_moves_to_and_from_none() -> None:
    """Joints without a velocity limit: it comes from infinity and goes there, and is a number."""
    robot = load_robot("kuka_lwr")
    robot.model.limits.velocity[2] = np.inf
    controller, state = Controller(robot), Simulator("kuka_lwr").state()
    limit = controller.constraints.one_of(JointVelocityLimit).limit
    controller.start(state)
    controller.step(state)
    for goal in (1.0, 0.0, 0.0):  # 0: those of the robot
        controller.tune({"velocity_limit": goal}, 10.0 * DT)
        seen = []
        begin = controller.step(replace(state, time=state.time + DT)).time
        for step in range(11):
            controller.step(replace(state, time=begin + step * DT))
            seen.append(limit.copy())
        assert not np.isnan(seen).any()
        steps = np.diff(1.0 / np.array(seen), axis=0)
        assert (steps >= 0.0).all() or (steps <= 0.0).all()
        assert np.abs(steps[:, 2]).max() < 0.25  # 1.0 in all, without a jump
        assert limit[2] == (goal or np.inf)
        state = replace(state, time=begin + 10 * DT)


@pytest.mark.parametrize("duration", [-1.0, np.inf, np.nan])
def test_a_blend_that_would_not_end_is_rejected(duration: float) -> None:
    controller = _moving()
    with pytest.raises(InvalidValue, match="a finite number of at least 0 expected"):
        controller.tune({"formulation": "balanced"}, duration)
    assert not controller.tuning.moves


def test_a_budget_beside_a_change_of_formulation_is_rejected_with_the_reason() -> None:
    controller = _moving()
    controller.tune({"rank_tolerance": 2e-4})  # from cascade to cascade
    with pytest.raises(InvalidValue, match="a change of formulation is under way"):
        controller.change_hierarchy("elbow > posture", torque_rate=5.0)


@pytest.mark.parametrize("value", [1e308, 1e200, 1e-200, 5e-324, 0.0, -1.0, float("nan")])
def test_no_number_raises_anything_but_a_refusal(value: float) -> None:
    """A parameter service whose check raises another error ends the controller."""
    controller = _moving()
    for name in controller.tuning.names:
        try:
            controller.tuning.check({name: value})
        except GhcError as error:
            assert name.split(".")[-1] in str(error)
