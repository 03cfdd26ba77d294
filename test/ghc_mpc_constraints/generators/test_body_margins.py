"""The generator of margins: announced rises, sudden ones, and an arm that gives way smoothly."""

from __future__ import annotations

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.types import Array
from ghc_mpc_constraints.generators.body_margins import (
    BodyMargins,
    BodyMarginSettings,
    MarginSchedule,
)
from ghc_mpc_constraints.obstacle_motion.approach import ReactionTime
from ghc_sim_bridge.simulation.simulator import Simulator

DT = 1e-3  # [s]
PERIOD = 0.01  # [s] of the generator


def _schedule(times: list[float], margins: list[float]) -> MarginSchedule:
    return MarginSchedule.checked("ball", times, margins, [1e3] * len(times))


def _generator(**settings: bool) -> BodyMargins:
    return BodyMargins(BodyMarginSettings(reaction=ReactionTime(0.2, 0.3), **settings))


def _in_force(generator: BodyMargins, seconds: float, start: float = 0.0) -> Array:
    """Margins in force at the ticks from `start` on."""
    count = round(seconds / PERIOD)
    return np.array([generator.tick(start + k * PERIOD).lower[0, 0] for k in range(count)])


def test_an_announced_rise_is_complete_when_it_takes_effect() -> None:
    """And it moves with a bounded acceleration: no step between ticks."""
    generator = _generator()
    generator.observe(_schedule([0.0, 2.0], [0.0, 0.1]), 0.0)
    found = _in_force(generator, 3.0)
    assert found[:20] == pytest.approx(0.0, abs=1e-3)
    assert (found[200:] >= 0.1 - 1e-6).all()
    assert np.abs(np.diff(found, 2)).max() / PERIOD**2 < 3.0  # [m/s^2]


@pytest.mark.parametrize("smoothing", [True, False])
def test_a_sudden_rise_is_due_after_the_reaction_time(smoothing: bool) -> None:
    """0.1 m at 0.2 m/s: half a second; without smoothing it is there at once."""
    generator = _generator(smoothing=smoothing)
    generator.observe(_schedule([0.0], [0.0]), 0.0)
    _in_force(generator, 1.0)
    generator.observe(_schedule([1.0], [0.1]), 1.0)
    found = _in_force(generator, 1.5, start=1.0)
    late = 0.5 if smoothing else 0.0
    assert (found[round(late / PERIOD) :] >= 0.1 - 1e-6).all()
    assert (found[0] < 1e-3) == smoothing


def test_each_of_several_sudden_rises_has_its_own_reaction_time() -> None:
    """0.02 m after 0.3 s, 0.2 m at 0.2 m/s after one second; and nothing moves faster for it."""
    generator = _generator()
    generator.observe(_schedule([0.0], [0.0]), 0.0)
    _in_force(generator, 1.0)
    generator.observe(_schedule([1.0, 1.05], [0.02, 0.2]), 1.0)
    found = _in_force(generator, 2.0, start=1.0)
    assert (found[30:] >= 0.02 - 1e-6).all()
    assert found[50] < 0.2
    assert (found[100:] >= 0.2 - 1e-6).all()
    assert np.diff(found).max() / PERIOD < 2.0 * 0.2


def test_a_sudden_rise_after_a_restart_is_due_after_the_reaction_time() -> None:
    """A generator that has taken over 0.02 m goes on from there, whatever comes first."""
    generator = _generator()
    generator.start_from("ball", 0.02, 1e3)
    generator.observe(_schedule([1.0], [0.1]), 1.0)
    found = np.array([generator.previews(1.0 + k * PERIOD)[0].lower[0, 0] for k in range(100)])
    assert found[0] == pytest.approx(0.02, abs=1e-3)
    assert (found[40:] >= 0.1 - 1e-6).all()


def test_a_margin_that_falls_needs_no_reaction() -> None:
    generator = _generator()
    generator.observe(_schedule([0.0], [0.1]), 0.0)
    _in_force(generator, 0.5)
    generator.observe(_schedule([0.5], [0.0]), 0.5)
    assert _in_force(generator, 1.5, start=0.5)[-1] == pytest.approx(0.0, abs=5e-3)


@pytest.mark.parametrize("again", [False, True])
def test_the_first_schedule_starts_from_the_margin_of_the_robot(again: bool) -> None:
    """`arms` of two_arms, 3 cm: 0.1 m more is due after half a second; also after a reset."""
    generator = BodyMargins(BodyMarginSettings(reaction=ReactionTime(0.2, 0.3), robot="two_arms"))
    given = MarginSchedule.checked("arms", [0.0], [0.13], [1e3])
    if again:
        generator.observe(given, 0.0)
        _in_force(generator, 1.0)
        generator.reset()
    generator.observe(given, 0.0)
    found = _in_force(generator, 1.5)
    assert found[0] == pytest.approx(0.03, abs=1e-6)
    assert np.abs(np.diff(found, 2)).max() / PERIOD**2 < 4.0  # [m/s^2]
    assert (found[50:] >= 0.13 - 1e-6).all()


def test_a_first_schedule_that_begins_later_is_announced() -> None:
    """Until then the margin of the robot holds; below it, none is planned."""
    generator = BodyMargins(BodyMarginSettings(robot="two_arms"))
    generator.observe(MarginSchedule.checked("arms", [2.0, 3.0], [0.1, -1.0], [1e3, 1e3]), 0.0)
    found = _in_force(generator, 5.0)
    assert found[:20] == pytest.approx(0.03, abs=1e-3)
    assert (found[200:300] >= 0.1 - 1e-6).all()
    assert found.min() >= 0.03 - 1e-9


def _peak(smoothing: bool) -> float:
    """Torque rate [Nm/s] when a ball beside the hand gets a margin 5 cm above its distance."""
    robot = ghc.Robot.from_urdf(
        ghc.load_robot("kuka_lwr").urdf,
        tasks=[ghc.posture("posture", stiffness=30.0, damping=20.0)],
        hierarchy="posture",
        constraints=[
            {
                "name": "bodies",
                "kind": "body_distance",
                "bodies": {"hand": {"frame": "tool", "at": [0, 0, 0], "radius": 0.05}},
                "obstacles": {"ball": {"at": [0.75, 0, 0.5], "radius": 0.05}},
                "margins": {"ball": {"margin": 0.0}},
            }
        ],
    )
    simulator = Simulator("kuka_lwr_obstacle", control_dt=DT)  # the tool at (0.55, 0, 0.5) m
    controller = ghc.Controller(robot, ghc.Settings(torque_rate_limit=0.0))
    controller.start(simulator.state())
    controller.set_reference("posture", simulator.state().q)
    constraint = controller.constraints.one_of(BodyDistance)
    generator = _generator(smoothing=smoothing)
    generator.observe(_schedule([0.0], [0.0]), 0.0)
    torques, margin = [], 0.0
    for tick in range(1000):
        state = simulator.state()
        if tick == 100:
            margin = float(constraint.distances()[0]) + 0.05
            generator.observe(_schedule([state.time], [margin]), state.time)
        if tick % 10 == 0:
            controller.follow(generator.tick(state.time), state.time)
        torques.append(controller.step(state).torque.copy())
        simulator.step(torques[-1])
    assert constraint.distances()[0] > margin - 0.01
    return float(np.abs(np.diff(torques, axis=0)).max()) / DT


def test_the_torque_rate_is_ten_times_lower_with_the_generator() -> None:
    assert _peak(smoothing=False) > 10.0 * _peak(smoothing=True)
