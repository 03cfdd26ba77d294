"""Samples of targets: what is rejected, what is estimated, and when a sample was taken."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.numerics.rotation import rotation_exp
from ghc_controller.reachable import ReachableSettings
from ghc_controller.reachable.arrival_clock import ArrivalClock
from ghc_controller.reachable.estimator import MotionEstimator
from ghc_controller.reachable.tangent import difference, moved
from ghc_controller.reachable.target_stream import TargetStream
from ghc_controller.robot.library import load_robot


def _stream() -> TargetStream:
    stream = TargetStream(load_robot("kuka_lwr").tasks[0], ReachableSettings())
    stream.begin(np.zeros(3))
    stream.add(1.0, np.array([0.5, 0.0, 0.5]), 1.0)
    return stream


@pytest.mark.parametrize(
    ("stamp", "position", "reason"),
    [
        (1.02, [math.nan, 0.0, 0.5], "finite numbers expected"),
        (1.3, [0.5, 0.0, 0.5], "clocks differ"),
        (0.2, [0.5, 0.0, 0.5], "or later expected"),
        (1.0, [0.5, 0.0, 0.5], "later than the last one"),
        (1.02, [3.5, 0.0, 0.5], "until two more samples agree"),
    ],
)
def test_bad_samples_are_refused_with_a_reason(
    stamp: float, position: list[float], reason: str
) -> None:
    stream = _stream()
    with pytest.raises(InvalidValue, match=reason):
        stream.add(stamp, np.array(position), 1.02)
    stream.add(1.02, np.array([0.5, 0.0, 0.5]), 1.02)  # goes on without it
    assert stream.time == 1.02


def test_a_sample_of_another_size_is_refused() -> None:
    with pytest.raises(WrongSize, match="position"):
        _stream().add(1.02, np.zeros(2), 1.02)


def test_a_far_jump_counts_once_it_is_confirmed() -> None:
    """A single glitch is dropped; a target that stays there is taken with the third sample."""
    stream = _stream()
    far = np.array([3.5, 0.0, 0.5])
    for k in (1, 2):
        with pytest.raises(InvalidValue, match="two more"):
            stream.add(1.0 + 0.02 * k, far, 1.0 + 0.02 * k)
    stream.add(1.06, far, 1.06)
    assert stream.jumps == 1
    for _ in range(300):
        position = stream.follow(1.06, 0.01)
    assert np.abs(position - far).max() < 1e-6


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("rate", [10.0, 20.0, 50.0, 100.0])
def test_stamps_from_arrivals_have_less_jitter(rate: float, seed: int) -> None:
    """5 ms of jitter, 2 % lost: after 1 s the spread is below three quarters of the arrivals'.

    That of stamps which are trusted, and those are most.
    """
    random = np.random.default_rng(seed)
    clock, found, doubts = ArrivalClock(0.005), [], []
    arrival = 0.0
    for k in range(400):
        if random.random() < 0.02:
            continue
        arrival = max(arrival + 1e-6, k / rate + abs(random.normal(0.0, 0.005)))
        found.append((clock.stamp(arrival) - k / rate, arrival - k / rate))
        doubts.append(clock.doubt)
    trusted = np.array(doubts[int(rate) :]) < 1.0
    stamps, arrivals = np.array(found[int(rate) :])[trusted].T
    assert stamps.std() < 0.75 * arrivals.std()
    assert trusted.mean() > 0.75


def test_stamps_grow_whatever_arrives() -> None:
    random = np.random.default_rng(4)
    clock = ArrivalClock(0.005)
    arrivals = np.cumsum(random.exponential(0.02, 500))
    stamps = [clock.stamp(arrival) for arrival in arrivals]
    assert (np.diff(stamps) > 0.0).all()


@pytest.mark.parametrize("rotation", [False, True])
def test_a_steady_motion_is_predicted(rotation: bool) -> None:
    """At 0.2 m/s or rad/s, 20 Hz: 0.1 s ahead within 1 mm, mrad."""
    rate = np.array([0.1, -0.1, 0.14])
    origin = rotation_exp(np.array([0.3, 0.2, -0.5])) if rotation else np.array([0.5, 0.1, 0.4])
    estimator = MotionEstimator(0.0, origin, rotation, ReachableSettings())
    for k in range(1, 100):
        estimator.add(0.05 * k, moved(origin, 0.05 * k * rate, rotation), 0.005)
    position, velocity, _ = estimator.at(5.05)
    assert (
        np.abs(difference(position, moved(origin, 5.05 * rate, rotation), rotation)).max() < 1e-3
    )
    assert np.abs(velocity - rate).max() < 1e-2


def test_without_samples_the_target_returns_to_the_last_one() -> None:
    estimator = MotionEstimator(0.0, np.zeros(3), False, ReachableSettings())
    for k in range(1, 50):
        estimator.add(0.02 * k, np.array([0.003 * k, 0.0, 0.0]), 0.005)
    position, velocity, acceleration = estimator.at(estimator.time + 2.0)
    assert np.array_equal(position, estimator.sample)
    assert not velocity.any()
    assert not acceleration.any()


def test_rare_samples_are_followed_slower_but_a_jump_is_not() -> None:
    """A jump of 0.3 m is followed at 10 Hz nearly as at 100 Hz; one of 2 cm is slower."""

    def way(rate: float, jump: float) -> float:
        stream = TargetStream(load_robot("kuka_lwr").tasks[0], ReachableSettings())
        origin = np.array([0.5, 0.0, 0.5])
        stream.begin(origin)
        for k in range(20):
            stream.add(k / rate, origin, k / rate)
        for k in range(100):
            stream.follow(19.0 / rate + 0.01 * k, 0.01)
        time = 20.0 / rate
        stream._estimators[0].restart(time, origin + [jump, 0.0, 0.0])
        places = [stream.follow(time + 0.01 * k, 0.01)[0] for k in range(1, 16)]
        return float(places[-1]) - 0.5

    assert way(10.0, 0.3) == pytest.approx(way(100.0, 0.3), rel=0.06)  # but for one plan
    assert way(10.0, 0.02) < 0.8 * way(100.0, 0.02)
