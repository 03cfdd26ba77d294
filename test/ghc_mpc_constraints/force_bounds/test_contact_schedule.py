"""Contact schedules: what is rejected and why; previews that no straight line leaves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from random_schedules import random_schedule

from ghc_controller.errors import GhcError
from ghc_mpc_constraints.previews.horizon import Horizon
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.raw_bounds import preview
from ghc_mpc_constraints.schedules.schedule_inbox import ScheduleInbox

NAN = float("nan")
BAD: list[tuple[dict[str, Any], list[str]]] = [
    ({"times": [0.0, 2.0, 1.0]}, ["times[1] = 2 s before times[2] = 1 s", "increasing"]),
    ({"times": [0.0, 1.0, 1.0]}, ["increasing times expected"]),
    ({"name": "hand"}, ["unknown contact 'hand'", "known: left_foot, right_foot"]),
    ({"name": ""}, ["unknown contact ''", "left_foot"]),
    ({"times": [0.0, NAN, 2.0]}, ["times[1] = nan given", "finite number"]),
    ({"lower": [0.0, NAN, 0.0]}, ["lower[1] = nan given", "finite number"]),
    ({"upper": [5.0, float("inf"), 5.0]}, ["upper[1] = inf given", "finite number"]),
    ({"lower": [0.0, -1.0, 0.0]}, ["lower[1] = -1 N given", "0 or more"]),
    ({"upper": [5.0, 5.0, -3.0]}, ["upper[2] = -3 N given", "0 or more"]),
    ({"upper": [5.0, 0.0]}, ["upper: size 2 given, 3 expected"]),
    ({"times": [], "lower": [], "upper": []}, ["no times given, at least one"]),
]


@pytest.mark.parametrize(("change", "words"), BAD)
def test_malformed_schedules_are_refused(change: dict[str, Any], words: list[str]) -> None:
    """The message names the field, what was given and what was expected."""
    fields = {
        "name": "left_foot",
        "times": [0.0, 1.0, 2.0],
        "lower": [0.0, 0.0, 0.0],
        "upper": [5.0, 0.0, 5.0],
        "known": ("left_foot", "right_foot"),
    }
    with pytest.raises(GhcError) as error:
        ContactSchedule.checked(**(fields | change))
    for word in words:
        assert word in str(error.value)


def test_lines_between_points_stay_inside_the_schedule() -> None:
    """500 random schedules, jumps anywhere: an interpolated preview is never looser than raw."""
    rng = np.random.default_rng(4)
    horizon = Horizon.of(0.01, 0.3)
    checked = 0
    for _ in range(500):
        schedule = random_schedule(rng, "foot", 0.0, 0.3)
        raw = preview(schedule, 0.0, horizon)
        points = horizon.times(0.0)
        fine = (np.arange(600) + 0.37) * 0.0005  # none of them on a point
        inside = np.array([schedule.at(time) for time in fine])
        lower, upper = (np.interp(fine, points, value) for value in (raw.lower, raw.upper))
        # Where neighboring entries have no force in common no line can be inside both.
        reach = 2 * horizon.step
        torn = [
            schedule.lower[i : i + 2].max() > schedule.upper[i : i + 2].min()
            or np.diff(schedule.times[i : i + 3]).min(initial=1.0) < reach
            for i in range(len(schedule.times) - 1)
        ]
        if any(torn):
            continue
        checked += 1
        assert (lower >= inside[:, 0] - 1e-9).all()
        assert (upper <= inside[:, 1] + 1e-9).all()
    assert checked > 150


def test_preview_at_its_points_is_never_looser_where_a_bound_exists() -> None:
    """1000 random schedules, torn ones included: raw bounds hold at every point."""
    rng = np.random.default_rng(5)
    horizon = Horizon.of(0.01, 0.3)
    for _ in range(1000):
        schedule = random_schedule(rng, "foot", 0.0, 0.3)
        raw = preview(schedule, 0.0, horizon)
        own = np.array([schedule.at(time + 1e-8) for time in horizon.times(0.0)])
        assert (raw.lower >= own[:, 0]).all()
        assert (raw.upper <= own[:, 1]).all()
        assert (raw.lower <= raw.upper).all()


def test_contradictory_entries_keep_the_upper_bound_and_say_so() -> None:
    schedule = ContactSchedule.checked("foot", [0.0, 0.1], [0.0, 40.0], [50.0, 30.0])
    raw = preview(schedule, 0.0, Horizon.of(0.01, 0.3))
    assert raw.conflict
    assert (raw.lower <= raw.upper).all()
    assert (raw.upper[10:] == 30.0).all()
    assert (raw.lower[12:] == 30.0).all()


def test_a_newer_schedule_replaces_from_its_first_time_and_the_past_is_dropped() -> None:
    old = ContactSchedule.checked("foot", [0.0, 1.0, 2.0, 3.0], [0] * 4, [10, 11, 12, 13])
    new = ContactSchedule.checked("foot", [2.5, 4.0], [0, 0], [20, 21])
    both = old.followed_by(new, 1.5)
    assert both.times.tolist() == [1.0, 2.0, 2.5, 4.0]
    assert both.upper.tolist() == [11.0, 12.0, 20.0, 21.0]
    late = old.followed_by(ContactSchedule.checked("foot", [0.5], [0], [5]), 1.5)
    assert late.times.tolist() == [0.5]
    assert late.at(1.5) == (0.0, 5.0)


def test_several_schedules_wait_side_by_side() -> None:
    """Latched schedules reach a new generator together: all count, in the order of the times."""
    inbox = ScheduleInbox(lockstep=False)
    schedules = [
        ContactSchedule.checked("foot", [0.0, 1.0 + k], [0.0, 0.0], [50.0, 10.0], (), known)
        for k, known in enumerate((None, 2.0, 1.0))
    ]
    for schedule in schedules:
        inbox.put(schedule, 0.0, running=False)
    assert inbox.due(0.5) == [schedules[0]]
    assert inbox.due(3.0) == [schedules[2], schedules[1]]
    assert inbox.due(3.0) == []
