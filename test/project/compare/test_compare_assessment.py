"""Which case is named on the first screen: accuracy by level, QPs, and what is not compared."""

from __future__ import annotations

from typing import Any

from benchmarks.compare.cases import CASES
from benchmarks.compare.pages.assessment import LEAST, RATIO, judge
from benchmarks.compare.pages.causes import CAUSES, UNKNOWN, cause, explained
from benchmarks.compare.pages.first_screen import first_screen, given_up
from benchmarks.compare.pages.overview import deciding_ratio

CASE = CASES["priority_switching"]


def result(*errors: float, qps: float = 0.0, **others: Any) -> dict[str, Any]:
    """One phase with one task per level."""
    tasks = [
        {"level": level, "task": f"task_{level}", "end": error, "mean": error, "max": error}
        for level, error in enumerate(errors, start=1)
    ]
    return {"phases": [{"hierarchy": "order", "tasks": tasks}], "qps": qps} | others


def test_equal_errors_are_no_loss_and_larger_ones_are_named() -> None:
    reference = result(1e-3, 0.2)
    within = result((1e-3 - 0.5 * LEAST) / RATIO, 0.2)
    assessment = judge(CASE, reference, within)
    assert assessment is not None and assessment.losses == ()
    assessment = judge(CASE, reference, result(5e-4, 0.2))
    assert assessment is not None
    assert [(loss.level, loss.task, loss.given_up) for loss in assessment.plain] == [
        (1, "task_1", False)
    ]


def test_a_level_below_one_that_the_other_lost_is_set_apart() -> None:
    assessment = judge(CASE, result(0.0, 0.2, 0.5), result(0.1, 0.1, 0.5))
    assert assessment is not None
    assert assessment.plain == ()
    assert [loss.level for loss in assessment.losses] == [2]


def test_two_tasks_of_one_level_do_not_excuse_each_other() -> None:
    reference, other = result(0.2, 0.0), result(0.1, 0.1)
    for each in (reference, other):
        for task in each["phases"][0]["tasks"]:
            task["level"] = 1
    assessment = judge(CASE, reference, other)
    assert assessment is not None
    assert len(assessment.plain) == 1


def test_rejected_and_stopped_runs_and_compromises_are_not_compared() -> None:
    reference = result(0.0)
    assert judge(CASE, reference, {"rejected": "no order"}) is None
    assert judge(CASE, reference, result(0.0, stopped_s=1.0)) is None
    assert judge(CASES["nonstrict"], reference, result(0.0)) is None


def test_more_qps_are_named_with_both_numbers() -> None:
    results = {
        CASE.name: {
            "cascade": result(0.0, qps=2.0),
            "hqp": result(0.0, qps=3.0),
            "ghc": result(0.1, qps=1.0),
        }
    }
    text = first_screen(results)
    assert "2 of 2 pairs" in text
    assert "no more QPs in 1" in text
    assert "2 against ghc (1)" in text
    assert "hqp (" not in text


def test_the_first_screen_names_case_task_and_errors() -> None:
    results = {CASE.name: {"cascade": result(0.0, 0.3), "hqp": result(0.0, 0.2)}}
    assert "hqp (task_2, 1/2: 0.3 / 0.2; ?)" in first_screen(results)
    assert CASE.title in first_screen(results)
    results = {CASE.name: {"cascade": result(0.0, 0.3), "hqp": result(0.1, 0.2)}}
    assert CASE.title not in first_screen(results)
    assert CASE.title in given_up(results)


def test_the_deciding_ratio_is_that_of_the_first_level_that_differs() -> None:
    reference = result(1e-9, 0.1, 0.1)
    assert deciding_ratio(CASE, result(0.0, 0.2, 0.01), reference) == (0.2 + LEAST) / (0.1 + LEAST)
    assert deciding_ratio(CASE, result(0.0, 0.1, 0.1), reference) == 1.0
    assert deciding_ratio(CASE, result(0.0, stopped_s=1.0), reference) is None


def test_the_causes_of_losses_are_named_and_listed_once() -> None:
    assert cause("standing", "hqp_transition") == cause("standing", "rhp_hqp") == "g"
    assert cause("upper_body_reactive_w0.01", "rhp_hqp") == "c"
    assert cause("priority_switching", "ghc") == UNKNOWN
    text = explained(["g", "c", "g", UNKNOWN])
    assert [line[2:7] for line in text.splitlines()] == ["**(c)", "**(g)"]
    assert all(f"({letter})" in explained(CAUSES) for letter in CAUSES)
