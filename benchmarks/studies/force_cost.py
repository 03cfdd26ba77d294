"""iCub at rest on both feet, every task at its reference: what does the force cost disturb?"""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.icub_states import SCENE
from benchmarks.models import install_model
from benchmarks.study_results import shown
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "force_cost"
TITLE = "Force cost against tasks, iCub standing still"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp", "weighted")
_HIERARCHIES = (
    "",
    "posture > center_of_mass",
    "posture > root_orientation > left_hand > center_of_mass",
    "posture",
)
_STEPS = 6


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Errors that the tasks would settle at: acceleration error over stiffness."""
    hierarchies = _HIERARCHIES[:1] if quick else _HIERARCHIES
    install_model("icub-models")
    found: dict[str, dict[str, Any]] = {}
    for name in formulations:
        found[name] = {way or "of the robot": _standing(name, way) for way in hierarchies}
    return {"facts": {"steps": _STEPS}, "formulations": found}


def _standing(formulation: str, hierarchy: str) -> dict[str, Any]:
    controller = ghc.Controller.for_robot(
        "icub",
        ghc.Settings(formulation=formulation, torque_rate_limit=0.0, hierarchy=hierarchy),
    )
    model = controller.model
    q = Simulator(SCENE, joint_names=model.joint_names).start
    still = np.zeros(model.nv)
    controller.observe(ghc.RobotState(0.0, q, still))
    for task in controller.robot.tasks:
        target = task.static_target(np.array(task.current(model)))
        controller.add_reference(ghc.ReferenceTrajectory.static(task, target))
    for step in range(_STEPS):
        result = controller.step(ghc.RobotState(1e-3 * step, q, still))
    problem, x = controller.problem(), result.solution.acceleration
    settled = {}
    for i, task in enumerate(controller.robot.tasks):
        if task.name in ("center_of_mass", "posture"):
            rows = slice(problem.starts[i], problem.starts[i + 1])
            error = problem.jacobian[rows] @ x - problem.target[rows]
            settled[task.name] = float(np.abs(error / task.stiffness).max())
    return {
        "status": result.status.name,
        "joint_acceleration": float(np.abs(x[model.nv - model.na :]).max()),
        "center_of_mass_mm": 1e3 * settled["center_of_mass"],
        "posture_mrad": 1e3 * settled["posture"],
    }


def table(result: dict[str, Any]) -> str:
    """One line per formulation and hierarchy."""
    lines = []
    for name, rows in result["formulations"].items():
        for hierarchy, row in rows.items():
            keys = ("joint_acceleration", "center_of_mass_mm", "posture_mrad")
            cells = [shown(row[key], ".2g") for key in keys]
            lines.append([name, hierarchy, row["status"], *cells])
    head = ["formulation", "hierarchy", "status", "largest acceleration [rad/s^2]"]
    head += ["center of mass [mm]", "posture [mrad]"]
    return (
        "At rest with every task at its reference the answer should be no acceleration at all. "
        "What remains comes from the cost on contact forces; the errors are those at which the "
        "tasks would come to rest (acceleration over stiffness).\n\n" + markdown_table(head, lines)
    )
