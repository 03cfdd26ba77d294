"""A seeded part of `make fuzz`, and what it found."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import strategies as st

from benchmarks.fuzz.campaign import run_target, table
from benchmarks.fuzz.run import all_targets
from benchmarks.fuzz.target import MESSAGE_BUDGET, Target
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.hierarchy import matrix_from_hierarchy

TARGETS = all_targets()
CASES = 60  # [-] of a target, less of files


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_nothing_undocumented(target: Target) -> None:
    """Times are for `make fuzz`: here they would depend on the machine."""
    target = replace(target, budget=math.inf)
    outcome = run_target(target, max(round(CASES * target.share), 4), first_seed=7)
    assert outcome.holds, table([outcome])
    assert outcome.cases >= 3


def test_targets_have_names_of_their_own() -> None:
    assert len({target.name for target in TARGETS}) == len(TARGETS)


def test_an_undocumented_error_is_found_and_named() -> None:
    def careless(case: int) -> None:
        if case == 3:
            raise ZeroDivisionError("by the case")

    outcome = run_target(Target("careless", st.integers(0, 5), careless), 50)
    assert not outcome.holds
    assert "ZeroDivisionError: by the case" in outcome.failures[0]


def test_a_slow_case_is_found() -> None:
    def slow(case: int) -> None:
        end = time.thread_time() + 2.0 * MESSAGE_BUDGET
        while case == 1 and time.thread_time() < end:
            pass

    outcome = run_target(Target("slow", st.integers(0, 1), slow), 4)
    assert not outcome.holds
    assert outcome.slowest_case == "1"


def test_a_documented_error_is_no_failure() -> None:
    def rejects(case: Any) -> None:
        raise InvalidValue("never")

    outcome = run_target(Target("rejects", st.integers(), rejects), 20)
    assert outcome.holds
    assert outcome.accepted == 0


def test_a_hierarchy_of_many_names_takes_a_time_that_grows_with_their_number() -> None:
    """It was the square: 78 ms of CPU for 3000 names, now 3 ms."""

    def taken(count: int) -> float:
        text = " > ".join(f"t{i}" for i in range(count))
        begun = time.thread_time()
        with pytest.raises(UnknownName):
            matrix_from_hierarchy(["elbow"], text)
        return time.thread_time() - begun

    few, many = (min(taken(count) for _ in range(5)) for count in (3_000, 48_000))
    assert many < 64.0 * few  # 16 times as many; the square would be 256
