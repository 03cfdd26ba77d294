"""A count is a warning for a while after it rose, and stays in the summary."""

from __future__ import annotations

from ghc_controller.ros.rejections import WARNED_FOR, Recent


def test_a_warning_ends_after_its_time_and_begins_again_with_another_one() -> None:
    now = [50.0]
    recent = Recent(lambda: now[0])
    assert recent.told(0, "0 rejected") == (False, "ok")
    assert recent.told(3, "3 rejected") == (True, "3 rejected")
    now[0] += WARNED_FOR
    assert recent.told(3, "3 rejected") == (True, "3 rejected")
    now[0] += 0.1
    assert recent.told(3, "3 rejected", "waiting") == (False, "waiting; before: 3 rejected")
    assert recent.told(4, "4 rejected") == (True, "4 rejected")


def test_a_count_that_begins_anew_is_no_fault() -> None:
    now = [50.0]
    recent = Recent(lambda: now[0])
    assert recent.rose(5)
    now[0] += WARNED_FOR + 1.0
    assert not recent.rose(2)
    assert recent.rose(3)
