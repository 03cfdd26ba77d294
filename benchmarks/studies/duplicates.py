"""Duplicate tasks at different levels, and references far out of reach."""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.study_results import shown
from ghc_controller.formulations import make_formulation
from ghc_controller.hierarchy import Priorities, generalized_projectors, smallest_singular_value
from ghc_controller.types import Bounds
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "duplicates"
TITLE = "Duplicated tasks and absurd references"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp", "weighted")
_SEED = 2
_DAMPING = 1e-8  # [-] w: so small that it hides nothing
_SIZES = (1e2, 1e4, 1e6, 1e9, 1e12)  # [m]
_QUICK = (1e2, 1e9)


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Residuals of the duplicate, and what one step answers to each reference."""
    sizes = _QUICK if quick else _SIZES
    problem = _duplicate()
    projectors = generalized_projectors(problem.jacobian, problem.starts, problem.alpha)
    facts = {
        "seed": _SEED,
        "w": _DAMPING,
        "sizes_m": list(sizes),
        "smallest_singular_value": smallest_singular_value(projectors),
    }
    found = {}
    for name in formulations:
        solution = make_formulation(name, ghc.FormulationSettings(_DAMPING)).solve(problem)
        rest = np.split(
            problem.jacobian @ solution.acceleration - problem.target, problem.starts[1:-1]
        )
        found[name] = {
            "residuals": [float(np.linalg.norm(part)) for part in rest],
            "far": {f"{size:.0e}": _far(name, size) for size in sizes},
        }
    return {"facts": facts, "formulations": found}


def _duplicate() -> ghc.ControlProblem:
    """Two equal tasks, strictly above each other, and a free one; all can be met together."""
    rng = np.random.default_rng(_SEED)
    J, x = rng.normal(size=(2, 7)), rng.normal(size=7)
    jacobian = np.ascontiguousarray(np.vstack([J, J, np.eye(7)[:2]]))
    free = Bounds(np.full(7, -np.inf), np.full(7, np.inf))
    return ghc.ControlProblem(
        jacobian=jacobian,
        target=jacobian @ x,
        starts=np.array([0, 2, 4, 6], dtype=np.int64),
        priorities=Priorities.of(np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])),
        velocity=np.zeros(7),
        mass_matrix=np.eye(7),
        bias=np.zeros(7),
        acceleration=free,
        torque=free,
        torque_limit=free,
    )


def _far(formulation: str, size: float) -> str:
    """Status of one step of the arm whose hand is asked to be `size` meters away."""
    controller = ghc.Controller.for_robot("kuka_lwr", ghc.Settings(formulation=formulation))
    state = ghc.RobotState(0.0, np.full(7, 0.4), np.zeros(7))
    controller.observe(state)
    task = controller.robot.tasks[0]
    target = task.static_target(np.array([size, 0.0, 0.0]))
    controller.add_reference(ghc.ReferenceTrajectory.static(task, target))
    held = controller.model.dynamics.bias.copy()
    result = controller.step(ghc.RobotState(0.0, state.q, state.v, torque=held))
    finite = "" if np.isfinite(result.torque).all() else ", not finite"
    return result.status.name + finite


def table(result: dict[str, Any]) -> str:
    """Residuals and statuses by formulation."""
    facts, lines = result["facts"], []
    sizes = [f"{size:.0e}" for size in facts["sizes_m"]]
    for name, row in result["formulations"].items():
        residuals = [shown(value, ".2e") for value in row["residuals"]]
        lines.append([name, *residuals, *(row["far"][size] for size in sizes)])
    head = ["formulation", "first copy", "second copy", "third task"]
    return (
        "Two copies of a task with strict priority over each other, and a third task without "
        "restriction; x meets all three together. Residuals of the tasks, no bounds, "
        f"w = {facts['w']:g} (smallest singular value of [P_1 .. P_3]: "
        f"{shown(facts['smallest_singular_value'])}). Behind them the status of one step of the "
        "KUKA, default settings, whose hand has a reference that many meters away.\n\n"
        + markdown_table([*head, *(f"{size} m" for size in sizes)], lines)
    )
