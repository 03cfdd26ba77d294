"""A generator that starts in the middle of a run, and the schedules that were sent before."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.schedule_history import LONGEST, QUIET, ScheduleHistory
from ghc_mpc_constraints.schedules.schedule_inbox import ScheduleInbox

STEP = 0.01  # [s]
START = 5.0  # [s]
IN_FORCE = 20.0  # [N]
OLD = ContactSchedule.checked("foot", [0.0], [0.0], [60.0])
NEW = ContactSchedule.checked("foot", [0.0, 3.0], [0.0, 0.0], [60.0, 20.0])


def _upper_after_a_restart(pause: float, waits: bool) -> np.ndarray:
    """First upper bounds of the plans from START on; OLD comes at START, NEW after a pause [s].

    Wired as the node wires them, wall clock and the robot's time alike.
    """
    generator, inbox, history = (
        ContactForceBounds(ForceBoundSettings(horizon=0.5)),
        ScheduleInbox(False),
        ScheduleHistory(),
    )
    generator.start_from("foot", 0.0, IN_FORCE)
    if waits:
        history.expect(["foot"])
    arrivals = [(START, OLD), (START + pause, NEW)]
    upper = []
    for k in range(100):
        now = START + k * STEP
        while arrivals and arrivals[0][0] <= now + 1e-9:
            inbox.put(arrivals.pop(0)[1], now, running=True)
            history.arrived("foot", now)
        for schedule in inbox.due(now, partial(history.is_complete, wall=now)):
            generator.observe(schedule, now)
        generator.hold_handed_over()
        upper.append(generator.tick(now).upper[0, 0])
    return np.array(upper)


@pytest.mark.parametrize("pause", [0.0, 0.03, 0.15])
def test_a_schedule_that_was_replaced_is_not_followed(pause: float) -> None:
    """20 N are active and asked for; the schedule of 60 N before that comes first."""
    assert (_upper_after_a_restart(pause, waits=True) == IN_FORCE).all()


def test_without_waiting_the_bound_would_jump() -> None:
    """What the test above is for: up at 125 N/s for 30 ms, and down at once."""
    upper = _upper_after_a_restart(0.03, waits=False)
    assert np.diff(upper).min() < -2.0


def test_the_last_schedule_is_followed_when_no_more_come() -> None:
    history = ScheduleHistory()
    history.expect(["foot"])
    assert not history.is_complete("foot", 0.0)
    history.arrived("foot", 1.0)
    history.arrived("foot", 1.1)
    assert not history.is_complete("foot", 1.1 + 0.9 * QUIET)
    assert history.is_complete("foot", 1.1 + 1.1 * QUIET)
    history.arrived("foot", 2.0)
    assert history.is_complete("foot", 2.0)
    assert history.is_complete("hand", 0.0)


def test_a_planner_that_goes_on_speaking_is_not_waited_for() -> None:
    history = ScheduleHistory()
    history.expect(["foot"])
    for k in range(11):
        history.arrived("foot", 0.5 * QUIET * k)
    assert not history.is_complete("foot", 0.9 * LONGEST)
    assert history.is_complete("foot", LONGEST)


def test_a_contact_without_a_schedule_stays_at_its_bounds_in_force() -> None:
    """Left out of the plan, it would get the bounds of the robot's file at once."""
    generator = ContactForceBounds(ForceBoundSettings(horizon=0.5))
    generator.start_from("foot", 3.0, IN_FORCE)
    generator.hold_handed_over()
    plan = generator.tick(START)
    assert plan.rows == ("foot",)
    assert plan.active == (True,)
    assert (plan.upper == IN_FORCE).all()
    np.testing.assert_allclose(plan.lower, 3.0, rtol=1e-12)
    generator.observe(OLD, START + STEP)
    rising = [generator.tick(START + k * STEP).upper[0, 0] for k in range(1, 100)]
    assert rising[0] == IN_FORCE
    assert 0.0 < np.diff(rising).max() < 130.0 * STEP
    assert rising[-1] > 55.0
