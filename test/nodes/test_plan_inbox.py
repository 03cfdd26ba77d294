"""Plans are handed over when they have begun, in their own epoch, whatever arrives around them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from ghc_msgs.msg import ContactForceBounds

from ghc_controller.contacts import ForceBoundsPlan, PlanStatus
from ghc_controller.plan_inbox_node import FORCE_BOUNDS, PlanInbox
from ghc_mpc_constraints.ros_conversions import force_bounds_message

MS = 1_000_000  # [ns]


def _plan(start_ms: int, epoch: int) -> ContactForceBounds:
    bounds = np.zeros((1, 3))
    plan = ForceBoundsPlan(
        *(start_ms * 1e-3, 0.01, ("foot",), bounds, bounds + 1.0),
        *((True,), (PlanStatus.SMOOTHED,), (False,), True),
    )
    return force_bounds_message(plan, start_ms * MS, epoch)


def _inbox() -> tuple[PlanInbox, list[float]]:
    followed: list[float] = []
    bounds = SimpleNamespace(follow=lambda plan: followed.append(plan.start))
    controller: Any = SimpleNamespace(force_bounds=bounds)
    return PlanInbox(controller, lambda *_: None, lambda *_: None), followed


def test_a_plan_made_ahead_waits_for_its_start() -> None:
    inbox, followed = _inbox()
    inbox.take(FORCE_BOUNDS, _plan(10, 0))
    inbox.take(FORCE_BOUNDS, _plan(20, 0))
    for now in range(9, 21):
        inbox.hand_over(0, now * MS)
    assert followed == [0.01, 0.02]


def test_a_late_plan_of_the_epoch_before_hides_none_of_the_new_one() -> None:
    inbox, followed = _inbox()
    inbox.take(FORCE_BOUNDS, _plan(0, 1))
    inbox.take(FORCE_BOUNDS, _plan(500, 0))
    inbox.hand_over(1, 0)
    assert followed == [0.0]
    inbox.hand_over(1, 600 * MS)
    assert followed == [0.0]
