"""The thesis' numbers, and the time that a tick takes."""

from __future__ import annotations

from pathlib import Path

import pytest

from ghc_sim_bridge.programs.studies import plan_of_studies
from ghc_sim_bridge.programs.studies.force_study import ForceCase, linearity, run_force
from ghc_sim_bridge.programs.studies.main import main
from ghc_sim_bridge.programs.studies.motion_study import MotionCase, run_motion
from ghc_sim_bridge.programs.studies.readings import READINGS
from ghc_sim_bridge.programs.studies.tick_times import TickCase, time_ticks


def test_force_derivative_falls_to_the_thesis_values() -> None:
    """5 N in one step are 500 N/s; at most 15.6 at alpha 0.1 and 11.1 at alpha 0.2."""
    assert run_force(ForceCase(weight=0.1)).largest_rate <= 15.6
    assert run_force(ForceCase(weight=0.2)).largest_rate <= 11.1


def test_horizon_beyond_a_second_changes_little() -> None:
    """Alpha 0.2: 0.1 to 1.0 s lowers the derivative to less than a quarter, 3.0 s by 3 % more."""
    rates = {h: run_force(ForceCase(weight=0.2, horizon=h)).largest_rate for h in (0.1, 1.0, 3.0)}
    assert rates[1.0] < 0.25 * rates[0.1]
    assert 0.97 * rates[1.0] < rates[3.0] < rates[1.0]


def test_derivative_is_linear_in_the_jump() -> None:
    runs = [run_force(ForceCase(jump, 0.4, 1.0)) for jump in (5.0, 20.0, 35.0, 50.0)]
    assert linearity(runs) >= 0.999


def test_overshoot_of_the_obstacle() -> None:
    """Constant weight: the same 20.6 % up to gamma = 1e-5, more beyond; with D at most 2 %."""
    small, thesis, large = (
        run_motion(MotionCase(jerk_weight=gamma)).overshoot for gamma in (1e-8, 1e-5, 1e-3)
    )
    assert thesis == pytest.approx(20.6, abs=0.1)
    assert small == pytest.approx(thesis, abs=0.1)
    assert large > 1.2 * thesis
    assert 0.0 < run_motion(MotionCase(dynamic=True)).overshoot <= 2.0


def test_the_only_reading_with_the_thesis_overshoot_is_a_larger_jump() -> None:
    near = [reading for reading in READINGS if 29.0 < reading.overshoot() < 33.0]
    assert [reading.outside for reading in near] == [0.5]


@pytest.mark.parametrize("generator", ["contact_force_bounds", "obstacle_bounds"])
def test_a_tick_with_four_takes_at_most_two_milliseconds(generator: str) -> None:
    """Median over 400 ticks that all have a change in their horizon; best of three.

    Time of this thread, so that what else the machine does is left out.
    """
    case = TickCase(generator, 4, 1.5)
    assert min(time_ticks(case).own for _ in range(3)) <= 2e-3


@pytest.mark.timeout(300)  # workers import everything anew
def test_studies_write_document_and_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A thinned sweep, in two processes: every figure that the document names is there."""
    for name, values in {
        "WEIGHTS": (0.1, 0.2),
        "HORIZONS": (0.5, 1.5),
        "JUMPS": (5.0, 50.0),
        "GAMMAS": (1e-5, 1e-3),
        "MOTION_HORIZONS": (0.5, 1.5),
        "POWERS": (7.0,),
    }.items():
        for module in ("plan_of_studies", "figures", "document"):
            target = f"ghc_sim_bridge.programs.studies.{module}.{name}"
            monkeypatch.setattr(target, values, raising=False)
    monkeypatch.setattr(plan_of_studies, "READINGS", READINGS[:1])
    assert main(["--docs", str(tmp_path), "--workers", "2", "--no-timing"]) == 0
    text = (tmp_path / "mpc_studies.md").read_text(encoding="utf-8")
    assert "15.57" in text
    assert "31 %" in text
    for picture in text.split("](figures/")[1:]:
        assert (tmp_path / "figures" / picture.split(")")[0]).stat().st_size > 5000
