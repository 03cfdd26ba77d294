"""Virtual obstacles: in time, continuous, never farther than measured; and what goes wrong."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.preview import Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.types import Array
from ghc_mpc_constraints.generators.obstacle_motion import ObstacleBounds, ObstacleSettings
from ghc_mpc_constraints.obstacle_motion.approach import ApproachQueue, ReactionTime
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement, frame_of
from ghc_mpc_constraints.previews.motion_weights import dynamic_weights

STEP = 0.01  # [s]
SAFE = 0.4  # [m]
NORMAL = np.array([2.0, -1.0, 2.0]) / 3.0  # from the obstacle to the frame, which is at zero
NAN = float("nan")


def _seen(distance: float, id: str = "box", aside: float = 0.0) -> Measurement:  # noqa: A002
    position = -distance * NORMAL + aside * frame_of(NORMAL)[1]
    return Measurement.checked(id, "tool", position, NORMAL, distance, SAFE)


def _away(planned: PlannedMotion, row: int = 0) -> float:
    """Distance [m] of the virtual obstacle along the normal, or its rate of a higher row."""
    return -float(planned.state[row] @ NORMAL)


def _run(generator: ObstacleBounds, distances: Array, period: int = 10) -> list[Preview]:
    """Ticks with a measurement every `period` ticks; NaN = the obstacle is not seen."""
    plans = []
    for k, distance in enumerate(distances):
        if k % period == 0:
            seen = [] if np.isnan(distance) else [_seen(distance)]
            generator.observe(seen, k * STEP)
        plans.append(generator.tick(k * STEP))
    return plans


def test_never_farther_than_measured_at_the_end_of_the_reaction_time() -> None:
    """40 random courses: each measurement holds from its reaction time on, until it is undone."""
    rng = np.random.default_rng(20)
    generator = ObstacleBounds(ObstacleSettings(reaction=ReactionTime(0.5, 0.2)))
    for _ in range(40):
        generator.reset()
        distances = np.repeat(rng.uniform(0.05, 0.42, 4), rng.integers(5, 40, 4))
        plans = _run(generator, distances)
        virtual = np.array([_away(plan.motions[0]) for plan in plans])
        assert virtual[0] == pytest.approx(SAFE + 0.05)
        for k in range(0, len(distances), 10):
            # Chained approaches add their ways, so the whole way bounds every deadline.
            due = k + int(np.ceil(((virtual[0] - distances[k]) / 0.5 + 0.2) / STEP))
            undone = np.flatnonzero(distances[k:] > distances[k])
            until = k + undone[0] if len(undone) else len(distances)
            assert (virtual[due:until] <= distances[k] + 1e-8).all()
    assert generator.second_opinions == 0


def test_motion_is_continuous_and_its_plan_is_followed() -> None:
    """Position, velocity and acceleration move by no more than rate times step, through jumps."""
    generator = ObstacleBounds(ObstacleSettings())
    distances = np.concatenate([np.full(100, 0.5), np.full(300, 0.25), np.full(200, 0.35)])
    plans = _run(generator, distances)
    inside = [plan for plan in plans if plan.motions[0].status is PreviewStatus.SMOOTHED]
    assert len(inside) == 500
    for before, after in itertools.pairwise(inside):
        planned = before.motions[0].trajectory(STEP)
        assert np.allclose(planned[1], after.motions[0].state, rtol=0.0, atol=1e-12)
        half = before.motions[0].at(0.5 * STEP, STEP)
        jerk = before.motions[0].jerk[0]
        assert np.allclose(half[2], before.motions[0].state[2] + 0.5 * STEP * jerk)
    jerks = np.array([np.abs(plan.motions[0].jerk[0]).max() for plan in inside])
    assert jerks.max() < 60.0


def test_at_rest_on_the_measured_position_nothing_moves() -> None:
    """An obstacle that stands still long enough is shown where it is, to 1e-4 m."""
    plans = _run(ObstacleBounds(ObstacleSettings()), np.full(700, 0.3))
    assert _away(plans[-1].motions[0]) == pytest.approx(0.3, abs=1e-4)
    plan = plans[-1].motions[0]
    assert np.allclose(plan.at(3.0, STEP)[0], plan.trajectory(STEP)[-1][0])
    assert np.array_equal(plan.at(3.0, STEP)[1:], np.zeros((2, 3)))


def test_outside_it_is_shown_as_measured_and_leaves_over_the_edge() -> None:
    """0.9 m -> 0.25 m -> out of sight: raw, then from the edge inwards, then out, then gone."""
    settings = ObstacleSettings()
    distances = np.concatenate([np.full(50, 0.9), np.full(350, 0.25), np.full(200, NAN)])
    plans = _run(ObstacleBounds(settings), distances)
    assert all(_away(plan.motions[0]) == pytest.approx(0.9) for plan in plans[:50])
    edge = SAFE + settings.margin
    assert _away(plans[50].motions[0]) == pytest.approx(edge)
    assert plans[50].motions[0].status is PreviewStatus.SMOOTHED
    last = next(k for k, plan in enumerate(plans) if not plan.motions)
    assert 410 < last < 500
    assert _away(plans[last - 1].motions[0]) >= edge - settings.margin
    assert plans[-1].motions == ()


def test_along_the_tangent_it_is_smoothed_as_well() -> None:
    """A step aside of 0.2 m: no jump of position, arrival within a millimetre after 3 s."""
    generator = ObstacleBounds(ObstacleSettings())
    tangent = frame_of(NORMAL)[1]
    aside = []
    for k in range(800):
        if k % 10 == 0:
            generator.observe([_seen(0.3, aside=0.0 if k < 300 else 0.2)], k * STEP)
        state = generator.tick(k * STEP).motions[0].state
        aside.append(state[0] @ tangent)
    assert np.abs(np.diff(aside)).max() < 0.01
    assert aside[-1] == pytest.approx(0.2, abs=1e-3)


def test_silent_sensor_is_noticed_and_the_obstacle_taken_to_be_closer() -> None:
    """After stale_after: status STALE, counted, and 5 cm closer than last seen."""
    generator = ObstacleBounds(ObstacleSettings())
    plans = _run(generator, np.full(500, 0.3))
    assert all(p.motions[0].status is PreviewStatus.SMOOTHED for p in plans)
    silent = [generator.tick(k * STEP) for k in range(500, 900)]
    assert silent[39].motions[0].status is PreviewStatus.SMOOTHED
    assert silent[45].motions[0].status is PreviewStatus.STALE
    assert generator.counts["sensor_silent"] == 1
    assert _away(silent[-1].motions[0]) == pytest.approx(0.25, abs=1e-3)
    generator.observe([_seen(0.3)], 9.0)
    assert generator.tick(9.0).motions[0].status is PreviewStatus.SMOOTHED


def test_smoothing_off_passes_positions_through() -> None:
    distances = np.concatenate([np.full(50, 0.9), np.full(50, 0.25), np.full(20, NAN)])
    plans = _run(ObstacleBounds(ObstacleSettings(smoothing=False)), distances)
    for plan, distance in zip(plans, distances, strict=True):
        assert len(plan.motions) == (not np.isnan(distance))
        for planned in plan.motions:
            assert planned.status is PreviewStatus.RAW
            assert np.allclose(planned.at(0.005, STEP), [-distance * NORMAL, [0] * 3, [0] * 3])


def test_restarted_generator_goes_on_from_the_motion_in_force() -> None:
    """Taken over in the middle of an approach: the next states are those of the old one."""
    old, new = ObstacleBounds(ObstacleSettings()), ObstacleBounds(ObstacleSettings())
    plan = _run(old, np.full(120, 0.25))[-1]
    new.start_from("box", plan.motions[0].trajectory(STEP)[1])
    new.observe([_seen(0.25)], 1.2)
    started = new.tick(1.2).motions[0]
    assert np.allclose(started.state, old.tick(1.2).motions[0].state, rtol=0.0, atol=1e-12)
    assert np.abs(started.jerk[0]).max() < 60.0


class _NoSolution:
    """Stands in for a QP that finds nothing."""

    def solve(self, *_: object) -> None:
        return None


def test_without_a_solution_the_plan_is_held_then_the_closest_position_taken() -> None:
    generator = ObstacleBounds(ObstacleSettings())
    good = _run(generator, np.full(100, 0.3))[-1].motions[0].trajectory(STEP)
    generator._planner.qp = _NoSolution()  # type: ignore[assignment]
    for k in range(1, 400):
        if k % 10 == 0:
            generator.observe([_seen(0.3)], 0.99 + k * STEP)
        plan = generator.tick(0.99 + k * STEP).motions[0]
        if k < 150:
            assert plan.status is PreviewStatus.HELD
            assert np.allclose(plan.state, good[k], rtol=0.0, atol=1e-9)
        elif k > 160:
            assert plan.status is PreviewStatus.TIGHTENED
            assert _away(plan) <= 0.3 + 1e-9
    assert generator.counts["tightened"] > 200


def test_approach_queue_keeps_deadlines() -> None:
    """A farther measurement takes no deadline away; chained approaches add their ways."""
    toward = np.array([1.0, 0.0, 0.0])
    reaction = ReactionTime(0.1, 0.3)
    at = [np.array([-d, 0.0, 0.0]) for d in (0.4, 0.2, 0.201, 0.15, 0.45)]
    queue = ApproachQueue(at[0], 0.0)

    def distances(*times: float) -> list[float]:
        return (-queue.preview(np.array(times)) @ toward).round(9).tolist()

    queue.move(at[1], toward, 3.0, reaction)
    assert distances(4.9, 4.999, 5.0, 9.0) == [0.4, 0.4, 0.2, 0.2]
    queue.move(at[2], toward, 3.1, reaction)  # a millimetre of noise
    assert distances(4.99, 5.0, 9.0) == [0.4, 0.201, 0.201]
    queue.move(at[3], toward, 3.2, reaction)
    assert distances(4.99, 5.0, 5.505, 5.515) == [0.4, 0.201, 0.201, 0.15]
    queue.move(at[4], toward, 3.3, reaction)
    assert distances(3.3, 9.0) == [0.45, 0.45]


def test_dynamic_weights_are_those_of_the_thesis() -> None:
    """10^-g where the obstacle is farthest, one where it is closest, one where nothing moves."""
    raw = np.concatenate([np.full(10, 0.4), np.full(5, 0.2)])
    assert dynamic_weights(raw, 7.0) == pytest.approx([1e-7] * 10 + [1.0] * 5)
    assert dynamic_weights(np.full(5, 0.4)).tolist() == [1.0] * 5


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"position": [0.0, NAN, 0.0]}, "position = .*nan.* finite"),
        ({"position": [0.0, 0.0]}, "position: size 2 given, 3 expected"),
        ({"normal": [0.0, 0.0, 0.0]}, "normal of length 0 given, 1 expected"),
        ({"distance": -0.1}, "distance = -0.1 m given"),
        ({"safe_distance": float("inf")}, "safe_distance = inf m given"),
        ({"id": ""}, "two names expected"),
        ({"frame": ""}, "two names expected"),
    ],
)
def test_malformed_measurements_are_refused(change: dict[str, Any], words: str) -> None:
    fields = {
        "id": "box",
        "frame": "tool",
        "position": [0.0, 0.0, 0.0],
        "normal": [1.0, 0.0, 0.0],
        "distance": 0.3,
        "safe_distance": 0.4,
    }
    with pytest.raises(GhcError, match=words):
        Measurement.checked(**(fields | change))


@pytest.mark.parametrize("name", ["margin", "stale_after", "power"])
def test_bad_settings_are_refused(name: str) -> None:
    with pytest.raises(InvalidValue, match=name):
        ObstacleBounds(ObstacleSettings(**{name: NAN}))
    with pytest.raises(InvalidValue, match="max_velocity"):
        ReactionTime(0.0, 0.3)
