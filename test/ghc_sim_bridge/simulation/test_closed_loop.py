"""Controller and simulator in one process: priorities change, torques stay within their rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from ghc_controller.controller import Controller
from ghc_controller.formulations import FORMULATIONS
from ghc_controller.hierarchy import Transition, matrix_from_hierarchy
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.settings import Settings
from ghc_controller.types import Array
from ghc_sim_bridge.simulation.simulator import Simulator

DT = 1e-3  # [s]
RATE = 1000.0  # [Nm/s]
START, SWAP = "posture > elbow > end_effector", "end_effector > elbow > posture"
TARGETS = {"end_effector": [0.61, 0.07, 0.82], "elbow": [0.044303, -0.357625, 0.484112]}


@dataclass(frozen=True)
class Run:
    """What a closed loop did, one row a control period."""

    torque: Array  # (T, 7) [Nm]
    velocity: Array  # (T, 7) [rad/s]
    error: Array  # (7,) of the last tick: end effector [m], elbow [m], posture [rad]
    counts: dict[str, int]


def _run(formulation: str, duration: float, rate: float, swap_at: float, seconds: float) -> Run:
    simulator = Simulator("kuka_lwr", control_dt=DT, physics_dt=DT)
    controller = Controller.for_robot(
        "kuka_lwr",
        Settings(
            formulation=formulation, torque_rate_limit=rate, velocity_limit=1.2, hierarchy=START
        ),
    )
    for name, position in TARGETS.items():
        task = controller.references.task(name)
        target = task.static_target(np.array(position))
        controller.add_reference(ReferenceTrajectory.static(task, target))
    swap = matrix_from_hierarchy(controller.robot.task_names, SWAP)
    controller.add_transition(Transition(swap, swap_at, duration), 0.0)
    torques, velocities = [], []
    state = simulator.state()
    for _ in range(round(seconds / DT)):
        result = controller.step(state)
        simulator.step(result.torque)
        state = simulator.state()
        torques.append(result.torque)
        velocities.append(state.v)
    errors = [float(np.linalg.norm(controller.stack.error_of(i))) for i in range(3)]
    counts = controller.counts | controller.gate.counts
    return Run(np.array(torques), np.array(velocities), np.array(errors), counts)


def _steps(run: Run) -> Array:
    """(T - 1,) largest change of a torque from one period to the next [Nm]."""
    return np.abs(np.diff(run.torque, axis=0)).max(axis=1)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_no_torque_step_above_the_rate_limit(formulation: str) -> None:
    """All tasks swapped at once, in every formulation: at most 1 Nm a millisecond."""
    run = _run(formulation, 0.0, RATE, 0.5, 1.2)
    assert _steps(run).max() <= RATE * DT * (1.0 + 1e-9)
    assert np.abs(run.velocity).max() <= 1.2 * (1.0 + 1e-3)
    assert run.counts["qp_failures"] == 0


@pytest.mark.parametrize("formulation", ["cascade", "ghc", "balanced"])
def test_slow_transitions_never_touch_the_rate_limit(formulation: str) -> None:
    """Ramps of 2 s: after the first 0.1 s every step stays well inside the limit."""
    run = _run(formulation, 2.0, RATE, 1.0, 4.0)
    assert _steps(run)[100:].max() < 0.5 * RATE * DT
    assert run.counts["gate_torque_rate"] == 0


@pytest.mark.parametrize("formulation", ["cascade", "balanced"])
def test_a_swap_at_once_is_fifty_times_rougher_than_a_ramp(formulation: str) -> None:
    """Peak torque rate: hqp switching at once against a ramp of 2 s."""
    at_once = _run("hqp", 0.0, 0.0, 0.5, 0.7)
    ramped = _run(formulation, 2.0, 0.0, 0.5, 3.0)
    assert _steps(at_once)[400:].max() > 50.0 * _steps(ramped)[400:].max()


@pytest.mark.parametrize("formulation", ["cascade", "balanced"])
def test_the_first_task_is_reached(formulation: str) -> None:
    """After the ramp the task on top converges at the rate of its own local controller.

    With stiffness 30 and damping 20 the slow pole is -1.63 /s: 4 s after the ramp a part of
    exp(-6.5) = 1.5e-3 of the error is left.
    """
    run = _run(formulation, 1.0, RATE, 0.2, 5.5)
    assert run.error[0] < 3e-3
    assert run.error[1] > 0.1  # the elbow's target is out of reach of the end effector's


@pytest.mark.parametrize("formulation", ["cascade", "balanced", "weighted"])
def test_an_arm_whose_targets_conflict_comes_to_rest(formulation: str) -> None:
    """Default settings, elbow 0.3 m from where it can go: after 6 s joints stand still for 2 s."""
    run = _run(formulation, 0.5, RATE, 0.0, 8.0)
    assert run.error[0] < 0.01
    assert run.error[1] > 0.2
    late = slice(round(6.0 / DT), None)
    assert np.abs(run.velocity[late]).max() < 5e-3
    assert _steps(run)[late].max() < 1e-3
