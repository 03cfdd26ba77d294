"""Stalls of processors: each is counted by itself, and the calmest one is chosen."""

from __future__ import annotations

import os

import pytest

from benchmarks.loops import stalls


def test_every_processor_of_this_process_is_counted() -> None:
    found = stalls.stalls(0, 0.05)
    assert list(found) == sorted(os.sched_getaffinity(0))
    assert all(0 <= late <= 100 for late in found.values())


@pytest.mark.parametrize(
    ("counts", "calmest"), [({0: 3, 1: 0, 2: 1}, 1), ({0: 2, 1: 2}, 1), ({0: 0, 1: 1}, 0)]
)
def test_the_calmest_has_the_fewest_stalls(
    monkeypatch: pytest.MonkeyPatch, counts: dict[int, int], calmest: int
) -> None:
    monkeypatch.setattr(stalls, "stalls", lambda _: counts)
    assert stalls.calmest_processor(0) == calmest


def test_a_priority_that_is_refused_is_the_normal_one(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refused)
    assert stalls.permitted_priority() == 0
