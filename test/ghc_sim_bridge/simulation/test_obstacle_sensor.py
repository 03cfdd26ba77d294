"""The simulated obstacle sensor: when it reads, what it sees, and what a wrong scene is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.scene.values import Obstacle, Sighting
from ghc_sim_bridge.simulation.obstacle_sensor import ObstacleSensor, position_at

MS = 1_000_000  # [ns]
TRACK = (Sighting(0.5, (1.0, 0.0, 0.0)), Sighting(1.0, None), Sighting(2.0, (0.3, 0.0, 0.0)))
POINT = Obstacle("ball", "tool", 0.2, None, TRACK)
PLANE = Obstacle("wall", "tool", 0.2, (-1.0, 0.0, 0.0), TRACK)

SCENE = """
robot: kuka_lwr
start: {joint_1: 0.1}
camera: {look_at: [0, 0, 0.5], distance: 2, azimuth: 120, elevation: -20}
obstacle_sensor: {period: 0.1}
obstacles:
  - id: ball
    protected_frame: tool
    safe_distance: 0.1
    track: [{time: 0.0, position: [1, 0, 0]}, {time: 2.0}]
"""


def test_readings_are_due_at_multiples_of_the_period_alone() -> None:
    sensor = ObstacleSensor([POINT], 0.1, 0.001)
    due = [k for k in range(301) if sensor.is_due(k * MS)]
    assert due == [0, 100, 200, 300]


@pytest.mark.parametrize(
    ("time", "x"),
    [(0, None), (499, None), (500, 1.0), (999, 1.0), (1000, None), (2000, 0.3), (9999, 0.3)],
)
def test_an_obstacle_jumps_at_its_times_and_is_seen_only_in_between(
    time: int, x: float | None
) -> None:
    position = position_at(POINT, time * MS)
    assert (None if position is None else position[0]) == x


def test_the_normal_of_a_point_leads_to_the_frame_at_the_distance() -> None:
    """Over random places: position + distance * normal is the frame."""
    rng = np.random.default_rng(3)
    sensor = ObstacleSensor([POINT], 0.1, 0.001)
    for frame in rng.uniform(-1.0, 1.0, size=(100, 3)):
        (reading,) = sensor.read(600 * MS, lambda _: frame)  # noqa: B023
        assert np.linalg.norm(reading.normal) == pytest.approx(1.0)
        reached = reading.position + reading.distance * reading.normal
        np.testing.assert_allclose(reached, frame, atol=1e-12)


def test_a_point_that_touches_its_frame_keeps_the_normal_that_it_came_with() -> None:
    sensor = ObstacleSensor([POINT], 0.1, 0.001)
    (before,) = sensor.read(600 * MS, lambda _: np.array([1.0, 0.2, 0.0]))
    (touching,) = sensor.read(700 * MS, lambda _: np.array([1.0, 0.0, 0.0]))
    np.testing.assert_array_equal(touching.normal, before.normal)
    assert touching.distance == 0.0
    again = ObstacleSensor([POINT], 0.1, 0.001).read(600 * MS, lambda _: np.array([1.0, 0, 0]))
    reset = sensor.read(600 * MS, lambda _: np.array([1.0, 0.0, 0.0]))  # time began again
    np.testing.assert_array_equal(reset[0].normal, again[0].normal)


def test_a_plane_has_its_normal_and_no_distance_below_zero() -> None:
    sensor = ObstacleSensor([PLANE], 0.1, 0.001)
    (reading,) = sensor.read(600 * MS, lambda _: np.array([0.6, 5.0, -2.0]))
    assert reading.normal.tolist() == [-1.0, 0.0, 0.0]
    assert reading.distance == pytest.approx(0.4)
    (behind,) = sensor.read(700 * MS, lambda _: np.array([1.5, 0.0, 0.0]))
    assert behind.distance == 0.0


def test_nothing_seen_is_an_empty_reading() -> None:
    sensor = ObstacleSensor([POINT, PLANE], 0.1, 0.001)
    assert sensor.read(1500 * MS, lambda _: np.zeros(3)) == ()


def test_a_period_between_the_control_periods_is_refused() -> None:
    with pytest.raises(InvalidValue, match=r"period 0\.1 s given, a multiple of .*0\.003 s"):
        ObstacleSensor([POINT], 0.1, 0.003)


def test_a_scene_with_obstacles_is_read_as_it_stands(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(SCENE, encoding="utf-8")
    scene = load_scene(file)
    assert scene.sensor_period == 0.1
    track = (Sighting(0.0, (1.0, 0.0, 0.0)), Sighting(2.0, None))
    assert scene.obstacles == (Obstacle("ball", "tool", 0.1, None, track),)
    assert load_scene("kuka_lwr").sensor_period is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("obstacle_sensor: {period: 0.1}", "", "obstacle_sensor: missing: nothing sees"),
        ("period: 0.1", "period: 0", r"obstacle_sensor.period: a number >= 0.001 expected"),
        ("period: 0.1", "rate: 10", r"obstacle_sensor.rate: unknown field; known: period"),
        ("id: ball", "normal: [1, 1, 0]\n    id: ball", r"obstacles\[0\].normal: length 1 exp"),
        ("time: 2.0", "time: 0.0", r"obstacles\[0\].track: increasing times expected, 0 s"),
        ("safe_distance: 0.1", "", r"obstacles\[0\].safe_distance: missing"),
        ("[1, 0, 0]", "[1, 0]", r"obstacles\[0\].track\[0\].position: 3 numbers expected"),
        ("{time: 2.0}", "{time: 2.0, position: }", r"track\[1\].position: it has no value: leave"),
    ],
)
def test_a_wrong_scene_is_told_file_and_field(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    file = tmp_path / "scene.yaml"
    assert old in SCENE
    file.write_text(SCENE.replace(old, new), encoding="utf-8")
    with pytest.raises(ConfigurationError, match=message) as caught:
        load_scene(file)
    assert "scene.yaml" in str(caught.value)
