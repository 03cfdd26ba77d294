"""The fencing motion of Jeong and Chang (2009): targets met, runs that stop, limits held."""

from __future__ import annotations

import pytest

from benchmarks.fencing_loop import Fencing, run_fencing
from ghc_controller.formulations import DampedLevels, FormulationSettings

PAPER = FormulationSettings(velocity_damping=0.0)
UNDAMPED = FormulationSettings(velocity_damping=0.0, damped_levels=DampedLevels.NONE)
PRINTED = FormulationSettings(velocity_damping=0.0, damped_levels=DampedLevels.LOWER)


def test_near_target_is_met_by_all_but_the_unifying_framework() -> None:
    """Mean of the last quarter: (18) 0.05 mm, (27) 1 mm, unifying framework beyond 100 mm."""
    near = Fencing("near")
    assert run_fencing("task_priority", UNDAMPED, near)["tip_end"] < 0.05
    assert run_fencing("task_priority", PRINTED, near)["tip_end"] < 1.0
    assert run_fencing("unifying", UNDAMPED, near)["tip_end"] > 100.0


def test_far_target_stops_the_undamped_laws_and_not_the_damped_one() -> None:
    """(27) stays 316 +- 5 mm away to the end; (18) and resolved acceleration stop by 1.2 s."""
    damped = run_fencing("task_priority", PRINTED, Fencing("far"))
    assert damped["stopped"] is None
    assert damped["tip_end"] == pytest.approx(316.0, abs=5.0)
    for name in ("task_priority", "resolved_acceleration"):
        stopped = run_fencing(name, UNDAMPED, Fencing("far", duration=1.3))["stopped"]
        assert stopped is not None
        assert stopped < 1.2


@pytest.mark.parametrize("variant", ["near_bounds", "far_bounds"])
@pytest.mark.parametrize("settings", [PAPER, FormulationSettings()], ids=["undamped", "damped"])
def test_limits_as_bounds_are_never_exceeded(variant: str, settings: FormulationSettings) -> None:
    found = run_fencing("task_priority", settings, Fencing(variant))
    assert found["excess"] < 1e-3  # [deg]
    assert found["failed"] == found["not_solved"] == 0
    assert found["stopped"] is None
    assert found["qps"] > 0
