"""Runs one after the other: the script sent again at later stamps gives the same plans."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.previews.preview import Preview
from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.schedule_inbox import ScheduleInbox

SETTINGS = ForceBoundSettings(horizon=0.25)
EVERY = 0.05  # [s] between the ticks of an epoch
END = 12.0  # [s]


def _script(start: float) -> list[tuple[float, ContactSchedule]]:
    """What a planner sends for a run that begins at `start` [s], and when [s]."""
    first = [start, start + 3.5, start + 7.0]
    script = ContactSchedule.checked("right_sole", first, [0.0] * 3, [400.0, 0.0, 400.0])
    surprise = ContactSchedule.checked("right_sole", [start + 3.1], [0.0], [50.0])
    newer = ContactSchedule.checked("right_sole", [start + 10.0], [0.0], [100.0])
    other = ContactSchedule.checked("left_sole", [start], [0.0], [200.0])
    return [
        (start, script),
        (start, surprise.known_at(start + 3.0)),
        (start + 1.0, other.known_at(start + 2.0)),
        (start + 2.0, newer.known_at(start + 5.0)),
    ]


def _run(bounds: ContactForceBounds, inbox: ScheduleInbox, start: float) -> list[Preview]:
    """Plans of all ticks; each schedule arrives before the tick at its time [s]."""
    plans, arrivals = [], _script(start)
    for k in range(round(END / EVERY)):
        now = start + k * EVERY
        while arrivals and arrivals[0][0] <= now + 1e-9:
            inbox.put(arrivals.pop(0)[1], now, running=k > 0)
        for schedule in inbox.due(now):
            bounds.observe(schedule, now)
        plans.append(bounds.tick(now))
    return plans


@pytest.mark.parametrize("lockstep", [True, False])
def test_every_run_is_planned_alike(lockstep: bool) -> None:
    """Nothing of the run before is left, whenever it ended; times differ by rounding."""
    bounds, inbox = ContactForceBounds(SETTINGS), ScheduleInbox(lockstep)
    first = _run(bounds, inbox, 0.0)
    assert (first[59].upper[1] == 400.0).all()
    np.testing.assert_allclose(first[60].upper[1][11:], 50.0)
    for start in (14.0, 1000.0):
        inbox.put(_script(start - 1.0)[1][1], start - 1.0, running=False)  # never known
        bounds.reset()
        inbox.forget()
        for before, after in zip(first, _run(bounds, inbox, start), strict=True):
            assert before.rows == after.rows
            assert before.active == after.active
            assert before.status == after.status
            np.testing.assert_allclose(before.lower, after.lower, atol=1e-9)
            np.testing.assert_allclose(before.upper, after.upper, rtol=1e-9, atol=1e-9)
