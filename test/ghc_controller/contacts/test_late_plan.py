"""Plans that come late: the current bounds neither jump up nor leave the newest plan."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ghc_controller.contacts import BoundsInForce
from ghc_controller.contacts.contact import OnStale
from ghc_controller.previews.preview import Preview
from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule

STEP, DT = 0.01, 0.001  # [s]
HIGH, LOW = 60.0, 20.0  # [N]
FASTEST = (HIGH - LOW) / 5.0 * 15.6  # [N/s] of a smoothed bound (thesis, fig. 5.10)


def _bounds() -> BoundsInForce:
    contact: Any = SimpleNamespace(
        name="foot", force_lower=0.0, force_upper=1000.0, active=True, on_stale=OnStale.HOLD
    )
    return BoundsInForce([contact])


def _run(
    times: list[float], upper: list[float], lower: list[float], delays: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(T, 3): time, lower and upper in force; (T, 2): lower and upper of the newest plan.

    From 0.5 s on the generator knows a schedule of these times. Plan k arrives `delays[k]` [s]
    after its start.
    """
    generator, bounds = ContactForceBounds(ForceBoundSettings(horizon=0.5)), _bounds()
    schedule = ContactSchedule.checked("foot", [0.0], lower[:1], upper[:1])
    generator.observe(schedule, 0.0)
    waiting: list[tuple[float, Preview]] = []
    newest, in_force, planned = generator.tick(0.0), [], []
    bounds.follow(newest, 0.0)
    for n in range(1, 3500):
        now = n * DT
        if n % 10 == 0:
            k = n // 10
            if k == 50:
                generator.observe(ContactSchedule.checked("foot", times, lower, upper), now)
            waiting.append((now + delays[k], generator.tick(now)))
        begun = [plan for due, plan in waiting if due <= now + 1e-9]
        waiting = waiting[len(begun) :]
        if begun:
            newest = begun[-1]
            bounds.follow(newest, now)
        values = bounds.at(now)
        in_force.append([now, values.lower[0], values.upper[0]])
        planned.append([side[0] for side in newest.at(now)])
    return np.array(in_force), np.array(planned)


@pytest.mark.parametrize("delay", [0.0, 0.003, 0.03, 0.2])
def test_a_bound_that_loosens_does_not_jump(delay: float) -> None:
    """News of which every plan is late: the upper bound rises at once, the lower one falls."""
    late = np.full(350, delay)
    run, plan = _run([0.0, 0.5], [LOW, HIGH], [15.0, 0.0], late)
    rates = np.abs(np.diff(run[:, 1:], axis=0)) / DT
    assert rates[:, 1].max() < 1.1 * FASTEST
    assert rates[:, 0].max() < 1.1 * 15.0 / (HIGH - LOW) * FASTEST
    assert (run[:, 2] <= plan[:, 1] + 1e-9).all()
    assert (run[:, 1] >= plan[:, 0] - 1e-9).all()
    np.testing.assert_allclose(run[-1, 1:], plan[-1], atol=0.2)


def test_plans_with_delays_that_change() -> None:
    """Seed 4: up to 60 ms, in the order of their starts."""
    rng = np.random.default_rng(4)
    starts = STEP * np.arange(350)
    late = np.maximum.accumulate(starts + rng.uniform(0.0, 0.06, 350)) - starts
    run, plan = _run([0.0, 0.5], [LOW, HIGH], [0.0, 0.0], late)
    assert np.abs(np.diff(run[:, 2])).max() / DT < 1.2 * FASTEST
    assert (run[:, 2] <= plan[:, 1] + 1e-9).all()
    assert (run[:, 1] <= run[:, 2]).all()
    assert run[-1, 2] == pytest.approx(plan[-1, 1], abs=0.2)


@pytest.mark.parametrize("delay", [0.0, 0.03])
def test_what_tightens_is_in_force_with_its_plan(delay: float) -> None:
    """The raw bound may lie on the plan: a late plan is not left for the sake of smoothness."""
    run, plan = _run([0.0, 0.7], [HIGH, LOW], [0.0, 0.0], np.full(350, delay))
    known = run[:, 0] > 0.5 + delay
    np.testing.assert_allclose(run[known, 2], plan[known, 1], rtol=0.0, atol=0.1)
    assert (run[run[:, 0] > 0.7, 2] <= LOW + 1e-9).all()


def test_raw_plans_step_also_when_they_are_late() -> None:
    generator = ContactForceBounds(ForceBoundSettings(horizon=0.5, smoothing=False))
    generator.observe(ContactSchedule.checked("foot", [0.0, 0.5], [0.0] * 2, [LOW, HIGH]), 0.0)
    bounds = _bounds()
    bounds.follow(generator.tick(0.48), 0.48)
    bounds.follow(generator.tick(0.5), 0.53)
    assert bounds.at(0.53).upper[0] == HIGH
