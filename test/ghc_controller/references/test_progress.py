"""Every accepted reference of several points ends once: done, or replaced."""

from __future__ import annotations

import numpy as np

from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.references.progress import ReferencePhase, ReferenceProgress
from ghc_controller.references.reference import ReferenceTrajectory


def _reference(start: float, *times: float, task: str = "hand") -> ReferenceTrajectory:
    times = times or (0.0,)
    position = np.zeros((len(times), 1))
    return ReferenceTrajectory(
        task, ReferenceSpace.VECTOR, 1, np.array(times), position, start_time=start
    )


def _ends(progress: ReferenceProgress, now: float) -> list[tuple[str, str]]:
    return [(event.id, event.phase.value) for event in progress.advance(now)]


def test_a_reference_is_done_after_its_last_point() -> None:
    progress = ReferenceProgress()
    progress.add("a", _reference(1.0, 0.0, 2.0))
    assert _ends(progress, 2.9) == []
    assert _ends(progress, 3.0) == [("a", "DONE")]
    assert _ends(progress, 9.0) == []


def test_a_newer_one_replaces_it_from_its_start_on() -> None:
    """Also a single point, which itself never ends; other tasks are not touched."""
    progress = ReferenceProgress()
    progress.add("a", _reference(1.0, 0.0, 2.0))
    progress.add("other", _reference(1.0, 0.0, 2.0, task="foot"))
    progress.add("b", _reference(2.0))
    assert _ends(progress, 1.9) == []
    assert _ends(progress, 2.0) == [("a", "REPLACED")]
    assert _ends(progress, 3.0) == [("other", "DONE")]
    assert progress.end_all(3.0, "hold") == []


def test_one_that_begins_after_the_end_replaces_nothing() -> None:
    progress = ReferenceProgress()
    progress.add("b", _reference(5.0, 0.0, 1.0))
    progress.add("a", _reference(1.0, 0.0, 2.0))
    assert _ends(progress, 7.0) == [("a", "DONE"), ("b", "DONE")]


def test_a_hold_ends_all_with_its_reason() -> None:
    progress = ReferenceProgress()
    progress.add("a", _reference(1.0, 0.0, 2.0))
    progress.add("b", _reference(8.0, 0.0, 2.0))
    progress.add("point", _reference(1.0))
    events = progress.end_all(2.0, "asked to hold")
    assert [(e.id, e.phase, e.reason) for e in events] == [
        ("a", ReferencePhase.REPLACED, "asked to hold"),
        ("b", ReferencePhase.REPLACED, "asked to hold"),
    ]
    assert _ends(progress, 20.0) == []


def test_every_reference_ends_exactly_once() -> None:
    """200 random ones of three tasks, at random times (seed 6)."""
    rng = np.random.default_rng(6)
    progress, ended = ReferenceProgress(), []
    now = 0.0
    for k in range(200):
        now += rng.uniform(0.0, 0.3)
        task = f"task_{rng.integers(3)}"
        times = (0.0, rng.uniform(0.1, 1.0))
        progress.add(str(k), _reference(now + rng.uniform(-0.5, 0.5), *times, task=task))
        ended += [name for name, _ in _ends(progress, now)]
    ended += [name for name, _ in _ends(progress, now + 5.0)]
    assert sorted(ended, key=int) == [str(k) for k in range(200)]


def test_one_that_started_before_that_in_force_is_never_done() -> None:
    """It came later, and the schedule does not follow it: neither a point nor a done path ends."""
    for in_force in (_reference(5.0), _reference(5.0, 0.0, 0.5)):
        progress = ReferenceProgress()
        progress.add("in force", in_force)
        progress.advance(6.0)
        progress.add("late", _reference(3.0, 0.0, 9.0))
        progress.add("over", _reference(3.0, 0.0, 1.0))
        assert sorted(_ends(progress, 6.0)) == [("late", "REPLACED"), ("over", "REPLACED")]
        assert progress.advance(20.0) == []
