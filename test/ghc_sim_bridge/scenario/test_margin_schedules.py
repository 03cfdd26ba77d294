"""Margins in a scenario: on their topic, checked by name, and compared with the distances."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ghc_controller.errors import UnknownName
from ghc_controller.robot.library import load_robot
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule
from ghc_sim_bridge.analysis.limit_history import margin_histories
from ghc_sim_bridge.logs.constraint_series import ConstraintSeries
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scenario.parameters import node_parameters
from ghc_sim_bridge.scenario.plan import RunOptions
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

TOPIC = "constraints/body_margin_schedule"


def test_margins_go_to_their_topic_and_are_known_late() -> None:
    found = load_scenario("two_arms").schedules()[TOPIC]
    assert [(one.name, one.known_from) for one in found] == [
        ("post", None),
        ("post", 3.0),
        ("arms", None),
        ("arms", 9.5),
    ]
    assert found[1].lower.tolist() == [0.06, -0.15]


def test_the_generator_knows_the_robot() -> None:
    plan = make_plan(load_scenario("two_arms"), RunOptions(), Path())
    assert node_parameters(plan)["body_margins"]["robot"] == "two_arms"


def test_an_unknown_margin_is_rejected_by_name() -> None:
    wrong = LimitSchedule.checked("legs", [0.0], [0.1], [1e3])
    scenario = replace(load_scenario("two_arms"), body_margin_schedules=(wrong,))
    with pytest.raises(UnknownName, match=r"margin in a schedule.*legs.*arms, own, post"):
        make_plan(scenario, RunOptions(), Path())


def test_the_least_distance_is_compared_with_both_margins() -> None:
    """A robot at rest over 12 s: the raw margin of the script, and one that was in force."""
    robot = load_robot("two_arms")
    model, rows = robot.model, 13
    q = np.tile(np.array([0.0, -0.4, 0.0, 1.5, 0.0, -0.6, 0.0] * 2), (rows, 1))
    time, zeros = np.arange(rows, dtype=np.float64), np.zeros((rows, model.nv))
    log = FullRateLog(
        *(time, q, zeros, zeros, zeros, zeros),
        source=np.zeros(rows, dtype=np.uint8),
        epoch=np.zeros(rows, dtype=np.uint32),
        cycle_time=time,
        wrenches={},
        joint_names=model.joint_names,
        control_dt=1.0,
    )
    margins = np.column_stack([np.full(rows, 0.05), np.full(rows, 1e3)])
    series = ConstraintSeries(time, {}, {}, {}, {"body_margins/arms": margins})
    found = margin_histories(series, load_scenario("two_arms"), log, robot)
    history = found["body_margins/arms"]
    assert set(found) == {"body_margins/arms"}
    assert np.ptp(history.value) == 0.0
    assert history.value[0] == pytest.approx(0.38, abs=0.01)
    assert history.raw[:, 0].tolist() == [0.03] * 10 + [0.15] * 3
    assert history.looser_than_raw == pytest.approx(0.1)
    assert history.beyond_raw == 0.0
