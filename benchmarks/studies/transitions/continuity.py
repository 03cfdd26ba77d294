"""KUKA: does the torque stay continuous through singularities, targets and active bounds?"""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.ramps.sweeps import problems_of, sweeps
from benchmarks.study_results import shown
from ghc_controller.formulations import SolutionStatus, make_formulation
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "continuity"
TITLE = "Continuity: sweeps of state, target and bounds"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp")
_POINTS, _QUICK = 600, 12


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Torque differences between consecutive points of each sweep."""
    points = _QUICK if quick else _POINTS
    settings = ghc.Settings().optimization
    found: dict[str, dict[str, Any]] = {name: {} for name in formulations}
    for sweep in sweeps(points):
        problems = list(problems_of(sweep))
        for name in formulations:
            formulation = make_formulation(name, settings)
            answers = [formulation.solve(problem) for problem in problems]
            solved = [a.torque for a in answers if a.status is SolutionStatus.SOLVED]
            path = np.array(solved)
            steps = np.abs(np.diff(path, axis=0)).max(axis=1)
            found[name][sweep.title] = {
                "largest_step_nm": steps.max(),
                "median_step_nm": np.median(steps),
                "way_nm": steps.sum(),
                "range_nm": np.ptp(path, axis=0).max(),
                "not_solved": len(answers) - len(solved),
            }
    return {"facts": {"points": points}, "formulations": found}


def table(result: dict[str, Any]) -> str:
    """One line per sweep and formulation."""
    lines = []
    for name, found in result["formulations"].items():
        for sweep, row in found.items():
            keys = ("largest_step_nm", "median_step_nm", "way_nm", "range_nm")
            cells = [shown(row[key]) for key in keys]
            lines.append([sweep, name, *cells, str(row["not_solved"])])
    lines.sort(key=lambda line: line[0])
    head = ["sweep", "formulation", "largest step [Nm]", "median step [Nm]"]
    head += ["sum of steps [Nm]", "range [Nm]", "not SOLVED"]
    return (
        f"{result['facts']['points']} points per sweep, at rest; steps of the torque (largest "
        "joint) between neighbors. A posture sweep moves 1 mrad per point, a target sweep 3 mm. "
        "Box: bound on all joint accelerations [rad/s^2]; a box sweep shrinks it from 60 to 3.\n\n"
        + markdown_table(head, lines)
    )
