"""Whole studies of the default formulation against what is asked of it: `make test-long`.

What is asked and not reached is marked with what was measured; a mark that is no longer needed
fails.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import pytest

from benchmarks.studies import load_studies
from benchmarks.studies.bodies import GOAL_BELOW, GOAL_RATIO
from benchmarks.studies.phases import BASELINE, RATIO_GOALS
from benchmarks.studies.targets.teleoperation import LARGEST_ERROR, LARGEST_STEP
from ghc_controller.formulations import DEFAULT_FORMULATION

pytestmark = [pytest.mark.long, pytest.mark.timeout(7200)]

Found = Mapping[str, Any]
_AT_ONCE = "hqp"  # of the switch that the default is compared with


@pytest.fixture(scope="session")
def measured() -> Iterator[dict[str, Found]]:
    """Results of this run by study."""
    yield {}


def _run(measured: dict[str, Found], name: str, *formulations: str) -> Found:
    """Each study runs once, since several goals are judged by one run."""
    if name not in measured:
        chosen = formulations or (DEFAULT_FORMULATION,)
        measured[name] = load_studies()[name].run(False, chosen)["formulations"]
    return measured[name][DEFAULT_FORMULATION]


def _excess(found: Found) -> float:
    """Largest of levels 1 and 2 over the reference, [-] of abs(b)."""
    levels = {str(level): values for level, values in found["excess"].items()}
    return float(max(levels["1"]["max"], levels["2"]["max"]))


@pytest.mark.parametrize("kind", ["fixed base", "in contact"])
def test_strict_levels_are_exact(measured: dict[str, Found], kind: str) -> None:
    """600 problems with bounds: excess over a hard cascade of the same damping, violation."""
    found = _run(measured, "exactness")[kind]
    assert found["status"] == {"SOLVED": 300}
    assert _excess(found) <= 1e-6
    assert max(found["violation"].values()) <= 1e-6


def test_random_bounded_problems_are_exact(measured: dict[str, Found]) -> None:
    """200 problems, each row a bound in reach."""
    found = _run(measured, "random_bounded")
    assert found["status"]["SOLVED"] == 200
    assert _excess(found) <= 1e-6
    assert found["worst_violation"] <= 1e-6


def test_hard_problems_are_never_solved_wrongly(measured: dict[str, Found]) -> None:
    """1000 badly scaled ones: no wrong SOLVED, no exception, nothing beyond the cap."""
    found = _run(measured, "hard_problems")
    assert not found["exceptions"]
    assert found["solved_with_violation"] == found["solved_not_finite"] == 0
    assert found["beyond_cap"] == 0


def test_ten_tasks_are_solved(measured: dict[str, Found]) -> None:
    """iCub, random strict orders of ten tasks, 200 states."""
    found = _run(measured, "icub_ten_tasks")
    assert found["status"]["SOLVED"] == 200
    assert found["wrong"] == 0


def test_long_chains_get_an_answer_within_the_cap(measured: dict[str, Found]) -> None:
    """63 and 126 joints with bounds."""
    for row in _run(measured, "chains").values():
        assert row["status"]["FAILED"] == row["beyond_cap"] == 0


@pytest.mark.parametrize("robot", ["kuka_lwr", "icub"])
def test_ramps_are_linear(measured: dict[str, Found], robot: str) -> None:
    """Largest of 100 equal steps of the shares: 1.1 % of the change."""
    kinds = _run(measured, "ramp_shares")[robot].values()
    assert max(kind["largest_percent"]["max"] for kind in kinds) <= 1.1


def test_ramps_of_random_postures_are_calm(measured: dict[str, Found]) -> None:
    """40 ramps of 0.3 s on iCub: torque step per ms."""
    assert _run(measured, "ramps")["largest_step_nm"]["p95"] <= 3.0


def test_the_phases_of_the_demo(measured: dict[str, Found]) -> None:
    """Accuracy, rest, torque rate at 1 ms and jerk of `priority_switching`."""
    phases = _run(measured, "phases", DEFAULT_FORMULATION, _AT_ONCE)["defaults"]["phases"]
    switch = measured["phases"][_AT_ONCE][BASELINE]["phases"][1]
    for key, ratio in RATIO_GOALS.items():
        assert switch[key] >= ratio * phases[1][key]
    assert max(phase["first"] for phase in phases) <= 3e-5
    assert max(phase["speed"] for phase in phases) <= 1e-3
    assert max(phase["torque_rate"] for phase in phases[1:]) <= 300.0
    assert phases[1]["jerk"] <= 140.0


def test_standing(measured: dict[str, Found]) -> None:
    """Center of mass by 2 cm, and as far as the feet carry it."""
    found = _run(measured, "standing")
    assert found["2 cm"]["error_m"] <= 1e-4
    assert found["2 cm"]["without_qp"] >= 0.98
    assert found["8 cm sideways"]["fell_at_s"] is None
    ticks = found["8 cm sideways"]["status"]
    assert ticks["SOLVED"] > 0
    assert ticks["RELAXED"] == ticks["FALLBACK"] == 0


@pytest.mark.parametrize(
    ("robot", "position", "velocity"),
    [
        ("kuka_stiff", 1e-4, 1.0),
        ("kuka_soft", 1e-4, 1.0),
        ("kuka_stiffer", 1e-3, 5.0),
        ("icub_arms", 1e-4, 1.0),
    ],
)
def test_limits_hold_in_the_aggressive_loop(
    measured: dict[str, Found], robot: str, position: float, velocity: float
) -> None:
    """New targets all the time, torque rate limit on: beyond limits by [rad] and [%], no FALLBACK.

    RELAXED is judged where the gains are those that were asked for, 400 1/s^2.
    """
    for run in _run(measured, "aggressive_loop")[robot].values():
        assert run["position_excess_rad"] <= position
        assert run["velocity_excess_percent"] <= velocity
        assert run["status"]["FALLBACK"] == 0
        if robot == "kuka_stiff":
            assert run["status"]["RELAXED"] <= 1e-3 * sum(run["status"].values())


def test_budgets_are_kept_and_used(measured: dict[str, Found]) -> None:
    """What a ramp adds to the torque rate, and how long it takes."""
    for row in _run(measured, "budgets").values():
        assert row["stalled"] == 0
        assert row["added_over_budget"]["max"] <= 1.02
        assert row["duration_over_shortest"]["max"] <= 1.2


@pytest.mark.parametrize(
    ("quantity", "limit"),
    [
        pytest.param(
            "torque_step_nm",
            1e-2,
            marks=pytest.mark.xfail(strict=True, reason="1.07e-2 in two UR5 pairs that move"),
        ),
        pytest.param(
            "joint_speed",
            1e-2,
            marks=pytest.mark.xfail(strict=True, reason="pairs that creep: up to 1.3 rad/s"),
        ),
    ],
)
def test_conflicting_targets_come_to_rest(
    measured: dict[str, Found], quantity: str, limit: float
) -> None:
    """20 pairs per arm, from 10 to 14 s; [Nm per ms] and [rad/s]."""
    for arm in _run(measured, "conflicts").values():
        assert arm["diverged"] == 0
        assert arm[quantity]["max"] <= limit


@pytest.mark.parametrize("robot", ["two_arms", "icub"])
def test_bodies_keep_their_margins(measured: dict[str, Found], robot: str) -> None:
    """60 s of random targets, judged by coal; a margin raised at once, raw and smoothed."""
    found = _run(measured, "bodies")[robot]
    for run in found["targets"].values():
        assert run["below_margin_m"] <= GOAL_BELOW
        assert run["active_share"] > 0.1
    assert found["free"]["below_margin_m"] > 10.0 * GOAL_BELOW
    assert min(run["ratio"] for run in found["contacts"].values()) >= GOAL_RATIO


def _teleoperation(measured: dict[str, Found], stamps: str, rate: float) -> list[Found]:
    """Runs of all seeds."""
    runs: list[Found] = _run(measured, "teleoperation")["runs"]
    return [run for run in runs if run["stamps"] == stamps and run["rate"] == rate]


@pytest.mark.parametrize("rate", sorted(LARGEST_ERROR))
@pytest.mark.parametrize("stamps", ["sender", "arrival"])
def test_an_operator_is_followed_closely(
    measured: dict[str, Found], stamps: str, rate: float
) -> None:
    """Mean error against the operator's curve at the same time [m]."""
    for run in _teleoperation(measured, stamps, rate):
        assert run["mean"] <= LARGEST_ERROR[rate]


@pytest.mark.parametrize(
    ("stamps", "rate"),
    [
        pytest.param(
            stamps,
            rate,
            marks=[pytest.mark.xfail(strict=True, reason="0.0101; the motion by itself has 0.005")]
            if (stamps, rate) == ("arrival", 20.0)
            else [],
        )
        for stamps in ("sender", "arrival")
        for rate in sorted(LARGEST_ERROR)
    ],
)
def test_an_operator_is_followed_smoothly(
    measured: dict[str, Found], stamps: str, rate: float
) -> None:
    """Torque step [Nm per ms]."""
    for run in _teleoperation(measured, stamps, rate):
        assert run["step"] <= LARGEST_STEP
