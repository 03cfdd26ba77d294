"""Invariants of the force bounds over thousands of random schedules, and what goes wrong."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from random_schedules import random_schedule, raw_at

from ghc_controller.errors import InvalidValue
from ghc_controller.previews.preview import Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule

STEP = 0.01  # [s]
SHORT = ForceBoundSettings(step=STEP, horizon=0.25)
TIGHT = 1e-9  # [N]


def _schedule(times: list[float], upper: list[float], lower: float = 0.0) -> ContactSchedule:
    return ContactSchedule.checked("foot", times, [lower] * len(times), upper)


def _ticks(
    generator: ContactForceBounds, count: int, start: int = 0
) -> Iterator[tuple[float, Preview]]:
    for k in range(start, start + count):
        yield k * STEP, generator.tick(k * STEP)


@pytest.mark.parametrize("feasible", [True, False])
def test_invariants_over_random_schedules(feasible: bool) -> None:
    """1500 runs each: Fmin <= lower <= upper <= Fmax at every point wherever such a bound exists.

    Schedules overlap, jump off the grid, contradict themselves (feasible = False), and are
    replaced between ticks, with entries in the past as well (late). Of a contradiction the upper
    bound is kept.
    """
    rng = np.random.default_rng(10 + feasible)
    generator = ContactForceBounds(SHORT)
    for _ in range(1500):
        generator.reset()
        generator._schedules.clear()
        known: list[tuple[float, ContactSchedule]] = []
        for k in range(6):
            now = k * STEP
            if k == 0 or rng.random() < 0.3:
                late = 0.0 if k == 0 else rng.uniform(-0.05, 0.05)
                schedule = random_schedule(rng, "foot", now + late, 0.3, feasible)
                known.append((now, schedule))
                generator.observe(schedule, now)
            plan = generator.tick(now)
            merged = generator._schedules["foot"]
            raw = np.array([merged.at(t + 1e-8) for t in generator.horizon.times(now)])
            lower, upper = plan.lower[0], plan.upper[0]
            assert (lower <= upper).all()
            assert (upper <= raw[:, 1] + TIGHT).all()
            possible = raw[:, 0] <= raw[:, 1]
            assert (lower >= raw[:, 0] - TIGHT)[possible].all()
            assert (upper == raw[:, 1])[~possible].all()
            assert plan.status == (PreviewStatus.SMOOTHED,)
            assert plan.conflict[0] or possible.all()
    assert generator.second_opinions == 0


def test_merged_schedule_is_the_newest_that_has_begun() -> None:
    """200 runs: what the generator keeps says the same as all schedules in order of arrival."""
    rng = np.random.default_rng(12)
    for _ in range(200):
        generator = ContactForceBounds.__new__(ContactForceBounds)
        generator._schedules = {}
        known: list[tuple[float, ContactSchedule]] = []
        for now in (0.0, 0.1, 0.2):
            schedule = random_schedule(rng, "foot", now + 0.1, 0.2)
            known = [(t, s) for t, s in known if s.times[0] < schedule.times[0]]
            known.append((now, schedule))
            generator.observe(schedule, now)
            times = now + np.linspace(0.0, 0.5, 101)
            merged = np.array([generator._schedules["foot"].at(t + 1e-8) for t in times])
            assert np.array_equal(merged, raw_at(known, times))


def test_equal_to_raw_when_nothing_changes() -> None:
    """Started on a constant schedule, the bounds are the raw ones to 1e-6 N for 10 s."""
    generator = ContactForceBounds(ForceBoundSettings())
    generator.observe(_schedule([0.0], [37.5], lower=12.25), 0.0)
    for _, plan in _ticks(generator, 1000):
        assert np.abs(plan.upper - 37.5).max() < 1e-6
        assert np.abs(plan.lower - 12.25).max() < 1e-6


def test_reaches_a_previewed_bound_in_time_and_starts_late_enough() -> None:
    """Zero when the raw bound is zero, and not reduced before the jump is in sight."""
    generator = ContactForceBounds(ForceBoundSettings())
    generator.observe(_schedule([0.0, 4.0], [5.0, 0.0]), 0.0)
    upper = np.array([plan.upper[0, 0] for _, plan in _ticks(generator, 420)])
    assert upper[400] == 0.0
    assert (upper[:250] > 5.0 - 1e-9).all()
    assert upper[399] > 0.0
    generator.observe(_schedule([5.0, 5.5 + 1e-9], [5.0, 0.0]), 4.2)  # off by a rounding
    on = [plan.active[0] for _, plan in _ticks(generator, 150, 450)]
    assert on == [False] * 50 + [True] * 50 + [False] * 50


def test_first_input_is_applied_and_a_repeated_tick_gives_the_same_plan() -> None:
    generator = ContactForceBounds(ForceBoundSettings())
    generator.observe(_schedule([0.0, 1.0], [5.0, 1.0]), 0.0)
    before = None
    for time, plan in _ticks(generator, 60):
        again = generator.tick(time)
        assert np.array_equal(again.upper, plan.upper)
        if before is not None:
            assert plan.upper[0, 0] == pytest.approx(before.upper[0, 1], abs=1e-12)
        before = plan


def test_smoothing_off_passes_raw_bounds_through() -> None:
    generator = ContactForceBounds(ForceBoundSettings(smoothing=False))
    schedule = _schedule([0.0, 0.5, 0.7], [5.0, 1.0, 3.0])
    generator.observe(schedule, 0.0)
    for time, plan in _ticks(generator, 100):
        assert plan.status == (PreviewStatus.RAW,)
        for moment in time + np.arange(10) * 1e-3:
            assert plan.at(moment)[1][0] == schedule.at(moment + 1e-8)[1]


def test_taken_over_bound_is_where_the_plan_starts() -> None:
    """A restarted generator goes on from the bound in force, without a jump."""
    generator = ContactForceBounds(ForceBoundSettings())
    generator.start_from("foot", 0.0, 20.0)
    generator.observe(_schedule([0.0], [60.0]), 0.0)
    upper = np.array([plan.upper[0, 0] for _, plan in _ticks(generator, 300)])
    assert upper[0] == 20.0
    assert np.diff(upper).max() / STEP < 40.0 / np.sqrt(0.1)
    assert upper[-1] > 59.0


class _NoSolution:
    """Stands in for a QP that finds nothing."""

    def solve(self, *_: object) -> None:
        return None


def test_without_a_solution_the_plan_is_held_then_tightened() -> None:
    """Held: the plan before, to the last digit; then down to the tightest one ahead."""
    generator = ContactForceBounds(ForceBoundSettings(horizon=0.5, tighten_rate=100.0))
    generator.observe(_schedule([0.0, 0.3, 0.8, 1.5, 1.6], [50, 20, 10, 30, 0], 2.0), 0.0)
    good = [plan for _, plan in _ticks(generator, 20)][-1]
    generator._qp = _NoSolution()  # type: ignore[assignment]
    before = good.upper[0, 1]
    for time, plan in _ticks(generator, 160, 20):
        raw_upper = generator._schedules["foot"].at(time + 1e-8)[1]
        assert plan.lower[0, 0] <= plan.upper[0, 0] <= raw_upper + TIGHT
        if time <= good.valid_until - STEP:
            assert plan.status == (PreviewStatus.HELD,)
            expected = good.at(time)[1][0]
            assert plan.upper[0, 0] == pytest.approx(min(expected, raw_upper), abs=1e-9)
        elif time < 1.1:
            assert plan.status == (PreviewStatus.TIGHTENED,) or plan.status == (
                PreviewStatus.HELD,
            )
            assert plan.upper[0, 0] <= before + TIGHT
        if raw_upper > 0.0:
            assert plan.upper[0, 0] > 0.0
        before = plan.upper[0, 0]
    assert generator.counts["held"] + generator.counts["tightened"] == 160


def test_tightens_at_the_stated_rate_and_stops_above_zero() -> None:
    """Without plan and solution: 100 N/s down to the tightest positive bound of the preview."""
    generator = ContactForceBounds(ForceBoundSettings(tighten_rate=100.0))
    generator._qp = _NoSolution()  # type: ignore[assignment]
    generator.observe(_schedule([0.0, 0.6, 0.9], [50.0, 10.0, 0.0]), 0.0)
    plan = generator.tick(0.0)
    assert plan.status == (PreviewStatus.TIGHTENED,)
    assert np.diff(plan.upper[0, :41]) / STEP == pytest.approx(np.full(40, -100.0))
    assert (plan.upper[0, 40:89] == 10.0).all()
    assert (plan.upper[0, 91:] == 0.0).all()  # the raw bound itself


@pytest.mark.parametrize("rate", [0.0, float("nan")])
def test_bad_settings_are_refused(rate: float) -> None:
    with pytest.raises(InvalidValue, match="tighten_rate"):
        ContactForceBounds(ForceBoundSettings(tighten_rate=rate))
