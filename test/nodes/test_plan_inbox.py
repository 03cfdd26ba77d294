"""Plans are handed over when they have begun, in their own epoch, whatever arrives around them."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ghc_msgs.msg import ConstraintPreview, ConstraintPreviews

from ghc_controller.errors import UnknownName
from ghc_controller.previews.preview import CONTACT_FORCES, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.ros.conversions.previews import previews_message
from ghc_controller.ros.previews import PreviewInbox

MS = 1_000_000  # [ns]


def _plan(start_ms: int, epoch: int, *contacts: str) -> ConstraintPreviews:
    """Of the foot, unless others are named."""
    names = contacts or ("foot",)
    c = len(names)
    bounds = np.zeros((c, 3))
    plan = Preview(
        CONTACT_FORCES,
        *(start_ms * 1e-3, 0.01, names, bounds, bounds + 1.0),
        *((True,) * c, (PreviewStatus.SMOOTHED,) * c, (False,) * c, True),
    )
    return previews_message((plan,), start_ms * MS, epoch)


class Bounds:
    """Stands in for the current bounds of a robot that has a foot, and remembers the plans."""

    def __init__(self) -> None:
        self.followed: list[float] = []  # [s] starts

    def follow(self, plan: Preview, now: float) -> tuple[UnknownName, ...]:
        """Take note of a plan."""
        assert plan.start <= now
        self.followed.append(plan.start)
        unknown = [name for name in plan.rows if name != "foot"]
        return tuple(UnknownName("contact", name, ["foot"]) for name in unknown)


def _inbox(
    reject: Callable[[str, str], None] = lambda *_: None,
) -> tuple[PreviewInbox, list[float]]:
    bounds = Bounds()
    controller: Any = SimpleNamespace(follow=bounds.follow, preview_kinds=("contact_forces",))
    return PreviewInbox(controller, lambda *_: None, reject), bounds.followed


def test_a_plan_made_ahead_waits_for_its_start() -> None:
    inbox, followed = _inbox()
    inbox.take(_plan(10, 0))
    inbox.take(_plan(20, 0))
    for now in range(9, 21):
        inbox.hand_over(0, now * MS)
    assert followed == [0.01, 0.02]


def test_a_late_plan_of_the_epoch_before_hides_none_of_the_new_one() -> None:
    inbox, followed = _inbox()
    inbox.take(_plan(0, 1))
    inbox.take(_plan(500, 0))
    inbox.hand_over(1, 0)
    assert followed == [0.0]
    inbox.hand_over(1, 600 * MS)
    assert followed == [0.0]


def test_a_plan_of_which_a_part_is_left_out_is_in_force() -> None:
    said: list[tuple[str, str]] = []
    inbox, followed = _inbox(lambda *words: said.append(words))
    inbox.take(_plan(0, 0, "heel", "foot", "toe"))
    inbox.hand_over(0, 0)
    assert followed == [0.0]
    reason = "unknown contact 'heel'; known: foot; unknown contact 'toe'; known: foot"
    assert said == [("constraints/preview/contact_forces.left_out", reason)]
    assert inbox.silent(0.05) == ""
    assert "last one 0.50 s old, it has ended" in inbox.silent(0.5)


def test_a_malformed_plan_is_refused_and_the_one_before_stays() -> None:
    said: list[tuple[str, str]] = []
    inbox, followed = _inbox(lambda *words: said.append(words))
    inbox.take(_plan(0, 0))
    inbox.hand_over(0, 0)
    bad = _plan(10, 0)
    bad.previews[0].status = [77]
    inbox.take(bad)
    inbox.hand_over(0, 10 * MS)
    assert followed == [0.0]
    assert said[0][0] == "constraints/preview/contact_forces"
    assert "status 77 given; known: 0 (SMOOTHED)" in said[0][1]
    assert "last one 0.50 s old" in inbox.silent(0.5)


def test_a_kind_that_nothing_follows_is_rejected_and_the_rest_is_taken() -> None:
    said: list[tuple[str, str]] = []
    inbox, followed = _inbox(lambda *words: said.append(words))
    message = _plan(0, 0)
    message.previews.append(ConstraintPreview(kind="weather"))
    inbox.take(message)
    inbox.hand_over(0, 0)
    assert followed == [0.0]
    reason = "unknown kind of preview 'weather'; known: contact_forces"
    assert said == [("constraints/preview", reason)]


def test_one_generator_plans_for_a_kind_until_it_is_silent() -> None:
    said: list[tuple[str, str]] = []
    inbox, followed = _inbox(lambda *words: said.append(words))
    for tick in range(3):
        for name in ("first", "second"):
            message = _plan(10 * tick, 0)
            message.previews[0].name = name
            inbox.take(message)
            inbox.hand_over(0, 10 * tick * MS)
    assert followed == [0.0, 0.01, 0.02]
    assert said[0] == (
        "constraints/preview/contact_forces",
        "generator 'second' given, while 'first' plans for this kind",
    )
    message = _plan(200, 0)
    message.previews[0].name = "second"
    inbox.take(message)
    inbox.hand_over(0, 200 * MS)
    assert followed[-1] == 0.2


def test_a_second_generator_of_a_kind_does_not_displace_the_first() -> None:
    """Previews of both come before each state, the second one's last."""
    said: list[tuple[str, str]] = []
    inbox, followed = _inbox(lambda *words: said.append(words))
    inbox.take(_plan(0, 0))
    inbox.hand_over(0, 0)
    for tick in range(1, 30):
        for name in ("", "second", "second", "second"):
            message = _plan(10 * tick, 0)
            message.previews[0].name = name
            inbox.take(message)
        inbox.hand_over(0, 10 * tick * MS)
    assert len(followed) == 30
    assert len(said) == 29


def test_a_constraint_of_another_package_that_raises_costs_no_state() -> None:
    said: list[tuple[str, str]] = []

    def follow(*_: object) -> tuple[UnknownName, ...]:
        raise KeyError("its own mistake")

    controller: Any = SimpleNamespace(follow=follow, preview_kinds=("contact_forces",))
    inbox = PreviewInbox(controller, lambda *_: None, lambda *words: said.append(words))
    inbox.take(_plan(0, 0))
    inbox.hand_over(0, 0)
    reason = "preview rejected, KeyError: 'its own mistake'"
    assert said == [("constraints/preview/contact_forces", reason)]


@pytest.mark.parametrize(
    ("wrong", "known"),
    [([0], True), ([8], True), ([2, 3, 4, 5, 6], True), ([7, 0, 9, 8], True), ([0, 8], False)],
)
def test_plans_of_another_epoch_displace_none(wrong: list[int], known: bool) -> None:
    """Whatever another generator sends: of a run that has ended, or of one that may come."""
    inbox, followed = _inbox()
    if known:
        inbox.hand_over(1, 0)
    inbox.take(_plan(10, 1))
    for number in range(20):
        inbox.take(_plan(10 + number, wrong[number % len(wrong)]))
    inbox.hand_over(1, 10 * MS)
    assert followed == [0.01]


def test_few_plans_wait_whatever_epochs_are_sent() -> None:
    inbox, _ = _inbox()
    inbox.hand_over(1, 0)
    for number in range(1000):
        inbox.take(_plan(10 + number, number))
        assert len(inbox._waiting["contact_forces"]) <= 9


def test_a_plan_of_the_next_run_waits_for_it() -> None:
    inbox, followed = _inbox()
    inbox.hand_over(1, 0)
    inbox.take(_plan(0, 2))
    for start in range(10, 60, 10):
        inbox.take(_plan(start, 1))
        inbox.hand_over(1, start * MS)
    inbox.hand_over(2, 0)
    assert followed == [0.01, 0.02, 0.03, 0.04, 0.05, 0.0]
