"""The bench of gn_qn_2018 in small: known figures of static tests, the document, the program."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.kinematics.planar_robot import START, planar_robot
from benchmarks.kinematics.planar_tests import planar_test, run_planar
from benchmarks.kinematics.run import main
from benchmarks.kinematics.variants import VARIANTS
from benchmarks.unreachable_loop import run_unreachable
from ghc_controller.formulations import FormulationSettings

STEPS = 600


def test_the_planar_robot_is_that_of_the_paper() -> None:
    """Chains s, th1, th2 and s, th1, th3 of links of 1 m, angles from +z to -x."""
    model = planar_robot()
    q = np.array([0.3, 0.2, -0.5, 0.9])
    model.update(q, np.zeros(4))
    shoulder = np.array([q[0] - np.sin(q[1]), np.cos(q[1])])
    for name, angle in (("ef2", q[1] + q[2]), ("ef3", q[1] + q[3])):
        expected = shoulder + [-np.sin(angle), np.cos(angle)]
        found = model.frame_position(model.frame_id(name))
        np.testing.assert_allclose(found[[0, 2]], expected, atol=1e-12)
    model.update(START, np.zeros(4))
    found = model.frame_position(model.frame_id("ef2"))
    np.testing.assert_allclose(found, [-2.0, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(("number", "paper"), [(4, 169), (6, 163), (8, 205)])
def test_gauss_newton_comes_to_rest_when_the_paper_says(number: int, paper: int) -> None:
    """Psi of Table I within 2 steps; these three targets can be reached."""
    figures = run_planar(planar_test(number, STEPS), VARIANTS["gn"])
    assert abs(figures["psi"] - paper) <= 2


@pytest.mark.parametrize("number", [4, 6, 7, 8])
def test_gn_qn_comes_to_rest_at_static_targets(number: int) -> None:
    """Psi at most 220, with one target 10 m out of reach (T7)."""
    figures = run_planar(planar_test(number, STEPS), VARIANTS["gn_qn"])
    assert figures["psi"] is not None
    assert figures["psi"] <= 220
    assert figures["sigma"] < 0.1


def test_gauss_newton_oscillates_out_of_reach() -> None:
    gn = run_planar(planar_test(7, STEPS), VARIANTS["gn"])
    assert gn["psi"] is None
    assert gn["sigma"] > 10.0


@pytest.mark.parametrize("formulation", ["balanced", "cascade"])
def test_second_order_terms_calm_a_torque_controlled_arm_out_of_reach(formulation: str) -> None:
    """Rate limit off, damping w |x|^2, 1 ms: at most 1500 Nm/s, and above 5000 without them."""
    rates = {}
    for second_order in (False, True):
        settings = FormulationSettings(velocity_damping=0.0, second_order=second_order)
        rates[second_order] = run_unreachable(formulation, settings, 2.0)["torque_rate"]
    assert rates[True] <= 1500.0
    assert rates[False] > 5000.0


def test_second_order_terms_make_nothing_worse_within_reach_at_the_default_damping() -> None:
    """Error of the first task after 5 s and speed in the last 3 s at 4 ms: at most as without."""
    runs = [
        run_unreachable("cascade", FormulationSettings(second_order=terms), 5.0, None, 4e-3)
        for terms in (False, True)
    ]
    without, with_terms = runs
    assert 0.0 < with_terms["error"] <= without["error"]
    assert with_terms["speed"] <= without["speed"]


def test_the_program_runs_in_small_and_writes_its_document(tmp_path: Path) -> None:
    arguments = ["1", "7", "--quick", "--output", str(tmp_path)]
    assert main(arguments) == 0
    results = json.loads((tmp_path / "kinematics" / "results.json").read_text(encoding="utf-8"))
    assert set(results) == {"quick", "T1", "T7"}
    assert set(results["T7"]) == set(VARIANTS)
    text = (tmp_path / "gn_qn.md").read_text(encoding="utf-8")
    assert "| T7 |" in text
    assert (tmp_path / "figures" / "gn_qn_errors.png").stat().st_size > 5_000
