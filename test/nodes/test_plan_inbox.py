"""Plans are handed over when they have begun, in their own epoch, whatever arrives around them."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
from ghc_msgs.msg import ContactForceBounds

from ghc_controller.contacts import ForceBoundsPlan, PlanStatus
from ghc_controller.errors import UnknownName
from ghc_controller.ros.previews import FORCE_BOUNDS, PlanInbox
from ghc_mpc_constraints.ros.conversions import force_bounds_message

MS = 1_000_000  # [ns]


def _plan(start_ms: int, epoch: int, *contacts: str) -> ContactForceBounds:
    """Of the foot, unless others are named."""
    names = contacts or ("foot",)
    c = len(names)
    bounds = np.zeros((c, 3))
    plan = ForceBoundsPlan(
        *(start_ms * 1e-3, 0.01, names, bounds, bounds + 1.0),
        *((True,) * c, (PlanStatus.SMOOTHED,) * c, (False,) * c, True),
    )
    return force_bounds_message(plan, start_ms * MS, epoch)


class Bounds:
    """Stands in for the bounds in force of a robot that has a foot, and remembers the plans."""

    def __init__(self) -> None:
        self.followed: list[float] = []  # [s] starts

    def follow(self, plan: ForceBoundsPlan, now: float) -> tuple[UnknownName, ...]:
        """Take note of a plan."""
        assert plan.start <= now
        self.followed.append(plan.start)
        unknown = [name for name in plan.contacts if name != "foot"]
        return tuple(UnknownName("contact", name, ["foot"]) for name in unknown)


def _inbox(reject: Callable[[str, str], None] = lambda *_: None) -> tuple[PlanInbox, list[float]]:
    bounds = Bounds()
    controller: Any = SimpleNamespace(force_bounds=bounds)
    return PlanInbox(controller, lambda *_: None, reject), bounds.followed


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


def test_a_plan_of_which_a_part_is_left_out_is_in_force() -> None:
    said: list[tuple[str, str]] = []
    inbox, followed = _inbox(lambda *words: said.append(words))
    inbox.take(FORCE_BOUNDS, _plan(0, 0, "heel", "foot", "toe"))
    inbox.hand_over(0, 0)
    assert followed == [0.0]
    reason = "unknown contact 'heel'; known: foot; unknown contact 'toe'; known: foot"
    assert said == [("constraints/contact_force_bounds.left_out", reason)]
    assert inbox.silent(0.05) == ""
    assert "last plan 0.50 s old, it has ended" in inbox.silent(0.5)


def test_a_malformed_plan_is_refused_and_the_one_before_stays() -> None:
    said: list[tuple[str, str]] = []
    inbox, followed = _inbox(lambda *words: said.append(words))
    inbox.take(FORCE_BOUNDS, _plan(0, 0))
    inbox.hand_over(0, 0)
    bad = _plan(10, 0)
    bad.status = [77]
    inbox.take(FORCE_BOUNDS, bad)
    inbox.hand_over(0, 10 * MS)
    assert followed == [0.0]
    assert said[0][0] == "constraints/contact_force_bounds"
    assert "status 77 given; known: 0 (SMOOTHED)" in said[0][1]
    assert "last plan 0.50 s old" in inbox.silent(0.5)
