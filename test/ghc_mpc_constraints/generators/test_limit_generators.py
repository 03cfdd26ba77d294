"""Joint and torque limits: never looser than raw, smooth, in time, resumed without a jump."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.previews.preview import JOINT_LIMITS, TORQUE_LIMITS, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_mpc_constraints import (
    BoundsGenerator,
    ContactSchedule,
    JointLimits,
    JointLimitSettings,
    LimitSchedule,
    TorqueLimits,
    TorqueLimitSettings,
)

STEP = 0.01  # [s]
KINDS = {
    "joint_limits": (JointLimits, JointLimitSettings),
    "torque_limits": (TorqueLimits, TorqueLimitSettings),
}


def _generator(name: str, **settings: object) -> BoundsGenerator:
    generator, kind = KINDS[name]
    return generator(kind(**settings))


def _random(rng: np.random.Generator, joint: str, start: float) -> LimitSchedule:
    """Limits on both sides of zero, new ones every 0.3 to 1 s."""
    times = start + np.cumsum(np.concatenate([[0.0], rng.uniform(0.3, 1.0, 4)]))
    lower, upper = -rng.uniform(0.3, 2.0, 5), rng.uniform(0.3, 2.0, 5)
    return LimitSchedule.checked(joint, times.tolist(), lower.tolist(), upper.tolist())


@pytest.mark.parametrize("name", KINDS)
def test_never_looser_than_raw_nor_crossed_over_random_schedules(name: str) -> None:
    """Seeds 0 to 4; between the points as well, and where a schedule comes too late."""
    for seed in range(5):
        rng = np.random.default_rng(seed)
        generator = _generator(name, horizon=0.5)
        schedules = {joint: _random(rng, joint, 0.0) for joint in ("a", "b")}
        for schedule in schedules.values():
            generator.observe(schedule, 0.0)
        for k in range(200):
            now = k * STEP
            if k == 100:
                surprise = _random(rng, "a", now + 0.02)
                schedules["a"] = schedules["a"].followed_by(surprise, now)
                generator.observe(surprise, now)
            preview = generator.tick(now)
            assert preview.rows == ("a", "b")
            assert (preview.lower <= preview.upper + 1e-9).all()
            for time in now + rng.uniform(0.0, 0.5, 5):
                lower, upper = preview.at(time)
                for row, joint in enumerate(preview.rows):
                    raw = schedules[joint].at(time)
                    assert lower[row] >= raw[0] - 1e-6
                    assert upper[row] <= raw[1] + 1e-6


@pytest.mark.parametrize(
    ("name", "kind"), [("joint_limits", JOINT_LIMITS), ("torque_limits", TORQUE_LIMITS)]
)
def test_a_step_is_reached_in_time_and_left_after(name: str, kind: str) -> None:
    generator = _generator(name)
    generator.observe(
        LimitSchedule.checked("a", [0.0, 2.0, 4.0], [-1.0] * 3, [1.0, 0.5, 1.0]), 0.0
    )
    upper, previews = [], []
    for k in range(700):
        previews.append(generator.tick(k * STEP))
        upper.append(previews[-1].upper[0, 0])
    assert previews[0].kind == kind
    assert all(preview.status == (PreviewStatus.SMOOTHED,) for preview in previews)
    assert upper[50] > 0.99
    assert upper[200] == pytest.approx(0.5, abs=1e-6)
    assert upper[400] == pytest.approx(0.5, abs=1e-6)
    assert upper[-1] == pytest.approx(1.0, abs=0.01)
    assert np.abs(np.diff(upper)).max() < 0.04, "per step: it does not jump"


def test_the_acceleration_of_a_joint_limit_does_not_jump() -> None:
    """Over three rates of ticks: the second difference changes by the jerk of a step at most."""
    generator = _generator("joint_limits")
    generator.observe(LimitSchedule.checked("a", [0.0, 2.0], [-1.0] * 2, [1.0, 0.5]), 0.0)
    upper = np.array([generator.tick(k * STEP).upper[0, 0] for k in range(300)])
    acceleration = np.diff(upper, 2) / STEP**2
    assert np.abs(acceleration).max() > 0.5
    assert np.abs(np.diff(acceleration)).max() < 0.7  # [rad/s^2]


@pytest.mark.parametrize("name", KINDS)
def test_a_restarted_generator_goes_on_from_the_limits_in_force(name: str) -> None:
    old = _generator(name)
    schedule = LimitSchedule.checked("a", [0.0, 2.0], [-1.0] * 2, [1.0, 0.5])
    old.observe(schedule, 0.0)
    for k in range(181):
        preview = old.tick(k * STEP)
    again = _generator(name)
    lower, upper = preview.at(1.85)
    assert upper[0] < 0.95
    in_force = Preview(
        *(preview.kind, 1.85, 1.0, ("a", "b"), np.array([[lower[0]] * 2, [-0.3] * 2])),
        *(np.array([[upper[0]] * 2, [0.2] * 2]), (True,) * 2),
        *((PreviewStatus.RAW,) * 2, (False,) * 2, False),
    )
    again.take_over(in_force)
    again.observe(schedule, 1.85)
    (first,) = again.previews(1.85)
    assert first.rows == ("a", "b"), "one without a schedule is held"
    assert first.upper[0, 0] == pytest.approx(min(upper[0], schedule.at(1.85)[1]), abs=1e-9)
    assert set(first.upper[1]) == {0.2}
    again.reset()
    assert again.previews(0.0)[0].rows == ()


@pytest.mark.parametrize("name", KINDS)
def test_without_smoothing_raw_limits_pass_through(name: str) -> None:
    generator = _generator(name, smoothing=False)
    generator.observe(LimitSchedule.checked("a", [0.0, 0.5], [-1.0] * 2, [1.0, 0.5]), 0.0)
    preview = generator.tick(0.2)
    assert preview.status == (PreviewStatus.RAW,)
    assert not preview.interpolate
    assert preview.at(0.495)[1] == 1.0
    assert preview.at(0.5)[1] == 0.5


@pytest.mark.parametrize("name", KINDS)
def test_without_a_solution_the_preview_before_is_held_and_then_tightened(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    generator = _generator(name, horizon=0.5)
    generator.observe(LimitSchedule.checked("a", [0.0, 1.0], [-1.0] * 2, [1.0, 0.5]), 0.0)
    before = generator.tick(0.0)
    monkeypatch.setattr(generator, "smooth", lambda *_: None)
    held = generator.tick(0.1)
    assert held.status == (PreviewStatus.HELD,)
    np.testing.assert_allclose(held.upper[0, :40], before.upper[0, 10:50])
    tightened = generator.tick(0.9)
    assert tightened.status == (PreviewStatus.TIGHTENED,)
    assert (
        tightened.upper[0] <= np.where(0.9 + STEP * np.arange(51) < 1.0 - 1e-9, 1.0, 0.5)
    ).all()
    assert (np.diff(tightened.upper[0]) <= 1e-12).all()
    assert generator.counts["held"] == generator.counts["tightened"] == 1


def test_schedules_that_say_the_same_are_equal() -> None:
    one, same, other = (
        ContactSchedule.checked("foot", [0.0, 1.0], [0.0, 0.0], [upper, 0.0])
        for upper in (50.0, 50.0, 40.0)
    )
    assert one == same and hash(one) == hash(same)
    assert one != other
    assert one != LimitSchedule.checked("foot", [0.0, 1.0], [0.0, 0.0], [50.0, 0.0])
