"""The rate limit counts from what was sent, whatever is reported."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller import Controller, Settings, load_robot
from ghc_controller.safety.rate_anchor import FIRST_SHARE, RateAnchor
from ghc_controller.types import RobotState

LIMIT = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])  # [Nm]
STEP, DT = 1.0, 1e-3  # [Nm] in a period, [s]


def _sent(torque: float) -> RateAnchor:
    anchor = RateAnchor(LIMIT, STEP, DT)
    anchor.first(None, np.zeros(7))
    anchor.sent(np.full(7, torque), 1.0)
    return anchor


@pytest.mark.parametrize("missed", [0, 1, 7, 18])
def test_after_missed_periods_the_anchor_is_what_was_sent(missed: int) -> None:
    anchor, now = _sent(5.0), 1.0 + (missed + 1) * DT
    assert not anchor.is_held(now)
    np.testing.assert_array_equal(anchor.at(now), np.full(7, 5.0))


@pytest.mark.parametrize("missed", [30, 400])
def test_after_a_hold_it_is_the_holding_torque_as_far_as_the_rate_leads(missed: int) -> None:
    now = 1.0 + (missed + 1) * DT
    assert _sent(5.0).is_held(now)
    np.testing.assert_allclose(_sent(5.0).at(now, np.full(7, 5.5)), 5.5)
    np.testing.assert_allclose(_sent(5.0).at(now, np.full(7, -1e4)), 5.0 - missed * STEP)
    np.testing.assert_allclose(_sent(5.0).at(now, np.full(7, np.nan)), 5.0)


def test_a_state_that_is_answered_twice_starts_from_the_same_torque() -> None:
    anchor = _sent(5.0)
    before = anchor.at(1.0 + DT).copy()
    anchor.sent(np.full(7, 6.0), 1.0 + DT)
    np.testing.assert_array_equal(anchor.at(1.0 + DT, np.full(7, 60.0)), before)


def test_the_first_report_is_believed_near_the_holding_torque_only() -> None:
    holding = np.linspace(-20.0, 20.0, 7)
    anchor = RateAnchor(LIMIT, STEP, DT)
    np.testing.assert_allclose(anchor.first(holding + 1.0, holding), holding + 1.0)
    lie = anchor.first(np.full(7, 1e4), holding)
    np.testing.assert_allclose(lie, holding + FIRST_SHARE * LIMIT)
    part = holding + 1.0
    part[2:4] = np.nan, np.inf
    expected = holding + 1.0
    expected[2:4] = holding[2:4]
    np.testing.assert_allclose(anchor.first(part, holding), expected)


@pytest.mark.parametrize("floating", [False, True])
def test_the_holding_torque_is_worked_out_only_where_it_counts(floating: bool) -> None:
    """At the first state, and after a hold unless the base floats: then as it was sent."""
    anchor, asked = RateAnchor(LIMIT, np.full(7, STEP), DT, floating), []

    def before(time: float) -> float:
        def holding() -> np.ndarray:
            asked.append(time)
            return np.full(7, 3.0)

        state = RobotState(time, np.zeros(7), np.zeros(7), np.full(7, 20.0))
        torque = anchor.before(state, holding)
        anchor.sent(np.full(7, 5.0), time)
        return float(torque[-1])

    assert before(1.0) == pytest.approx(20.0 if floating else 3.0 + FIRST_SHARE * LIMIT[-1])
    assert before(1.0 + DT) == before(1.0 + 2 * DT) == 5.0
    assert before(2.0) == pytest.approx(5.0 if floating else 3.0)
    assert asked == ([1.0] if floating else [1.0, 2.0])


def test_forged_efforts_never_move_a_torque_by_more_than_the_rate() -> None:
    """500 states of a moving arm, two in three missed, one effort in three forged (seed 3)."""
    rng = np.random.default_rng(3)
    controller = Controller(load_robot("kuka_lwr"), Settings(control_dt=DT))
    q = np.array([0.1, 0.3, 0.1, 1.2, 0.1, -0.9, 0.1])
    before = None
    for k in range(0, 1500, 3):  # two states in three are missed
        v = 0.2 * np.sin(0.01 * k + np.arange(7))
        effort = rng.choice([-1e4, 1e4, 1e300], 7) if rng.random() < 1 / 3 else before
        torque = controller.step(RobotState(k * DT, q + v, v, effort)).torque
        assert np.isfinite(torque).all()
        if before is not None:
            assert np.abs(torque - before).max() <= STEP + 1e-9
        before = torque


def test_a_period_longer_than_a_hold_without_a_rate_limit_has_an_anchor() -> None:
    anchor = RateAnchor(LIMIT, np.full(7, np.inf), 0.025)
    anchor.first(None, np.zeros(7))
    anchor.sent(np.full(7, 5.0), 1.0)
    np.testing.assert_array_equal(anchor.at(1.025, np.zeros(7)), np.full(7, 5.0))
