"""Preview control of the zero-moment point: it gets there, in time, and nothing jumps."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.errors import InvalidValue
from ghc_sim_bridge.scenario.walk.zmp_preview import GRAVITY, ZmpPreview

HEIGHT = 0.5  # [m]


def steps(preview: ZmpPreview, width: float = 0.14, count: int = 6) -> np.ndarray:
    """Two seconds in the middle, a second on each foot in turn, two in the middle again."""
    second = round(1.0 / preview.step)
    sides = [0.0, 0.0] + [0.5 * width * (-1) ** k for k in range(count)] + [0.0, 0.0]
    return np.repeat(sides, second)


def test_a_point_that_stays_is_kept() -> None:
    path = ZmpPreview(HEIGHT).path(np.full(300, 0.2), (0.2, 0.0, 0.0))
    assert path.position == pytest.approx(np.full(300, 0.2), abs=1e-9)
    assert np.abs(path.acceleration).max() < 1e-9


def test_the_point_follows_the_steps_and_the_body_sways_less() -> None:
    preview = ZmpPreview(HEIGHT)
    wanted = steps(preview)
    path = preview.path(wanted)
    settled = np.ones(len(wanted), dtype=bool)
    for jump in np.flatnonzero(np.diff(wanted)):
        settled[max(0, jump - 30) : jump + 31] = False  # 0.3 s about each step
    assert np.abs(path.zmp - wanted)[settled].max() < 0.01
    # In the periodic motion of an inverted pendulum, between the third and the fifth step.
    half = 0.5 * np.sqrt(GRAVITY / HEIGHT)  # [-] half a step in its time constants
    sway = np.abs(path.position[400:600]).max()
    assert sway == pytest.approx(0.07 * (1.0 - 1.0 / np.cosh(half)), abs=2e-3)
    assert path.position[-1] == pytest.approx(0.0, abs=1e-4)
    assert abs(path.velocity[-1]) < 1e-3


def test_the_body_moves_before_the_point_jumps() -> None:
    preview = ZmpPreview(HEIGHT)
    wanted = np.repeat([0.0, 0.1], 300)
    path = preview.path(wanted)
    assert path.position[299] > 0.03
    assert path.position[299 - preview.size - 5] == pytest.approx(0.0, abs=1e-6)


def test_the_samples_belong_to_one_motion() -> None:
    """Constant jerk between them: velocity and acceleration are the derivatives."""
    preview = ZmpPreview(HEIGHT, step=0.005)
    path = preview.path(steps(preview))
    dt = preview.step
    jerk = np.diff(path.acceleration) / dt
    velocity = path.velocity[:-1] + dt * path.acceleration[:-1] + dt**2 / 2 * jerk
    assert velocity == pytest.approx(path.velocity[1:], abs=1e-12)
    assert path.zmp == pytest.approx(path.position - HEIGHT / GRAVITY * path.acceleration)
    assert np.abs(jerk).max() < 200.0  # [m/s^3] no jump of the acceleration


def test_the_sample_time_hardly_matters() -> None:
    """The weight of the jerk's change scales with the step; the motion then is the same."""
    coarse, fine = ZmpPreview(HEIGHT, 0.02), ZmpPreview(HEIGHT, 0.005)
    a, b = coarse.path(steps(coarse)), fine.path(steps(fine))
    assert a.position == pytest.approx(b.position[::4], abs=5e-3)


@pytest.mark.parametrize("wrong", [0.0, -1.0, float("nan")])
def test_numbers_that_are_none_are_refused(wrong: float) -> None:
    with pytest.raises(InvalidValue, match="all > 0 expected"):
        ZmpPreview(wrong)
    with pytest.raises(InvalidValue, match="finite zero-moment points"):
        ZmpPreview(HEIGHT).path([0.0, float("inf")])
