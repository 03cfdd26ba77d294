"""What is recorded of a closed loop: QPs, changes of orders, errors, the end of a lost run."""

from __future__ import annotations

import numpy as np
import pytest

import ghc_controller as ghc
from benchmarks.compare.operations import gram_schmidt, law_operations
from benchmarks.compare.qp_counter import QpCounter
from benchmarks.compare.runs.closed_loop import Loop, Record, Span, run_loop
from benchmarks.compare.runs.measures import measure
from ghc_controller.hierarchy.levels import levels
from ghc_controller.hierarchy.priorities import Candidate
from ghc_controller.tasks.law import tracking
from ghc_sim_bridge import Simulator

ORDER = "end_effector > elbow > posture"
SWAPPED = "elbow > end_effector > posture"
TARGET = [0.61, 0.07, 0.82]  # [m]


def loop(formulation: str, duration: float, ramp: float = 0.0, swap: bool = False) -> Loop:
    settings = ghc.Settings(formulation=formulation, hierarchy=ORDER, torque_rate_limit=0.0)
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), settings)
    simulator = Simulator("kuka_lwr", joint_names=controller.model.joint_names)
    controller.start(simulator.state())
    controller.set_reference("end_effector", TARGET)
    if swap:
        controller.change_hierarchy(SWAPPED, start=0.01, duration=ramp)
    matrix = ghc.matrix_from_hierarchy(controller.robot.task_names, ORDER)
    return Loop(controller, simulator, (Span(ORDER, matrix.alpha, 0.0, duration),))


@pytest.mark.parametrize("rate", [1000.0, 0.0])
@pytest.mark.parametrize("formulation", ["cascade", "ghc", "hqp"])
def test_qps_are_counted_where_there_are_some(formulation: str, rate: float) -> None:
    """40 ms with torques of at most 20 Nm: a QP at some steps, and its operations.

    Without a rate limit the QPs of `cascade` are those of the compiled core alone.
    """
    settings = ghc.Settings(
        formulation=formulation, hierarchy=ORDER, torque_bound=20.0, torque_rate_limit=rate
    )
    controller = ghc.Controller(ghc.load_robot("kuka_lwr"), settings)
    simulator = Simulator("kuka_lwr", joint_names=controller.model.joint_names)
    controller.start(simulator.state())
    controller.set_reference("end_effector", [0.1, 0.6, 1.0])
    counter, solved = QpCounter(controller), 0
    for _ in range(40):
        counter.take()
        result = controller.step(simulator.state())
        qps, pivots, operations = counter.take()
        assert (qps > 0) == result.solution.qp_solved
        assert (operations > 0.0) == (qps > 0)
        assert pivots >= 0
        solved += qps
        simulator.step(result.torque)
    assert solved > 0


def test_a_step_in_one_call_counts_as_one_in_parts() -> None:
    """The same states, once with a law of one's own, which keeps the core from the whole step."""
    settings = ghc.Settings(hierarchy=ORDER, torque_bound=20.0, torque_rate_limit=0.0)
    whole, parts = (ghc.Controller(ghc.load_robot("kuka_lwr"), settings) for _ in range(2))
    parts.stack.law = lambda rows, velocity, time: tracking(rows, velocity, time)
    simulator = Simulator("kuka_lwr", joint_names=whole.model.joint_names)
    for controller in (whole, parts):
        controller.start(simulator.state())
        controller.set_reference("end_effector", [0.1, 0.6, 1.0])
    counters, found = [QpCounter(controller) for controller in (whole, parts)], 0
    for _ in range(40):
        state = simulator.state()
        torque = whole.step(state).torque
        parts.step(state)
        one, other = (counter.take() for counter in counters)
        assert one == other
        found += one[0]
        simulator.step(torque)
    assert found > 0


def test_a_ramp_is_one_change_between_its_orders() -> None:
    record = run_loop(loop("cascade", 0.06, ramp=0.03, swap=True))
    assert len(record.changes) == 1
    change = record.changes[0]
    assert [levels(alpha) for alpha in (change.before, change.after)] == [
        [[0], [1], [2]],
        [[1], [0], [2]],
    ]
    assert 28 <= sum(record.changing) <= 32
    assert not record.changing[0] and not record.changing[-1]


def test_a_switch_at_once_is_a_change_of_one_step() -> None:
    record = run_loop(loop("hqp", 0.04, swap=True))
    assert len(record.changes) == 1
    assert sum(record.changing) == 1


def test_a_run_that_is_lost_ends_and_has_figures() -> None:
    lost = loop("cascade", 0.05)
    ended = run_loop(Loop(lost.controller, lost.simulator, lost.spans, lowest=10.0))
    assert ended.stopped == 0.0
    result = measure(lost, ended)
    assert result["stopped_s"] == 0.0
    assert result["steps"] == 1
    assert len(result["phases"][0]["tasks"]) == 3


def test_the_last_quarter_is_a_mean_and_the_end_is_the_last_error() -> None:
    run = loop("cascade", 0.4)
    record: Record = run_loop(run)
    errors = np.array(record.errors)
    for last_quarter, rows in ((True, errors[300:]), (False, errors[-1:])):
        tasks = measure(run, record, last_quarter)["phases"][0]["tasks"]
        found = [task["end"] for task in tasks]
        np.testing.assert_allclose(found, rows.mean(axis=0), rtol=1e-12)


def test_a_blend_costs_its_orders_and_a_switch_one() -> None:
    starts = np.array([0, 3, 6, 13])
    names = ("a", "b", "c")
    alphas = [ghc.matrix_from_hierarchy(names, text).alpha for text in ("a > b > c", "b > a > c")]
    one = [Candidate(alphas[0], 1.0)]
    mixed = [Candidate(alphas[0], 0.7), Candidate(alphas[1], 0.3)]
    for formulation, at_least in (("cascade", 1.3), ("hqp_transition", 1.3), ("hqp", 1.0)):
        ratio = law_operations(formulation, 7, starts, mixed) / law_operations(
            formulation, 7, starts, one
        )
        assert at_least <= ratio < 2.0 or ratio == at_least == 1.0
    assert law_operations("ghc", 7, starts, mixed) == law_operations("ghc", 7, starts, one)


def test_gram_schmidt_does_not_go_on_beyond_the_dimension() -> None:
    assert gram_schmidt(7, 1) == 2.0 * 7
    assert gram_schmidt(7, 1, before=20) == gram_schmidt(7, 1, before=7)
    assert gram_schmidt(7, 3) == gram_schmidt(7, 2) + gram_schmidt(7, 1, before=2)
