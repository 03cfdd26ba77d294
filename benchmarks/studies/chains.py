"""63 and 126 chained joints with active bounds: is there a solution within the pivot limit?"""

from __future__ import annotations

from collections import Counter, defaultdict
from time import thread_time
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.problems.chains import SEED, chain_controller, chain_problems
from benchmarks.problems.problem_check import violation
from benchmarks.study_results import shown, shown_spread, spread
from ghc_controller.formulations import SolutionStatus, make_formulation
from ghc_controller.qp import SolverSettings
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "chains"
TITLE = "Chains of 63 and 126 joints with active bounds"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp")
CAP = SolverSettings().max_step_pivots  # of all QPs of a step
_JOINTS, _QUICK_JOINTS = (63, 126), (12,)
_COUNT, _QUICK = 48, 4  # problems per chain: a multiple of 12 has all kinds equally often


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Every formulation on the same problems."""
    joints, count = (_QUICK_JOINTS, _QUICK) if quick else (_JOINTS, _COUNT)
    found: dict[str, dict[str, Any]] = {name: {} for name in formulations}
    for size in joints:
        controller, free = chain_controller(size), make_formulation("cascade")
        solvers = {name: make_formulation(name) for name in formulations}
        records: dict[tuple[str, str], _Record] = defaultdict(_Record)
        for number, case in enumerate(chain_problems(controller, free, count)):
            for name, formulation in solvers.items():
                if number == 0:
                    formulation.solve(case.problem)  # workspaces are made outside the timing
                records[name, case.regime].add(formulation, case.problem)
        for (name, regime), record in records.items():
            found[name][f"{size} joints, {regime}"] = record.figures()
    facts = {"problems": {str(size): count for size in joints}, "seed": SEED, "cap": CAP}
    return {"facts": facts, "formulations": found}


class _Record:
    """Results of one formulation on one kind of problems."""

    def __init__(self) -> None:
        self.status: Counter[str] = Counter({s.name: 0 for s in SolutionStatus})
        self.pivots: list[int] = []
        self.times: list[float] = []  # [ms]
        self.active: list[int] = []
        self.worst = 0.0
        self.beyond_cap = 0

    def add(self, formulation: ghc.Formulation, problem: ghc.ControlProblem) -> None:
        """Solve one problem as a control step does."""
        formulation.solver.begin_step()
        begin = thread_time()
        solution = formulation.solve(problem)
        self.times.append(1e3 * (thread_time() - begin))
        used = CAP - formulation.solver.pivots_left
        self.pivots.append(used)
        self.beyond_cap += used > CAP
        self.status[solution.status.name] += 1
        if solution.status is SolutionStatus.SOLVED:
            self.worst = max(self.worst, violation(problem, solution))
            self.active.append(_active(problem, solution.acceleration))

    def figures(self) -> dict[str, Any]:
        return {
            "status": dict(self.status),
            "beyond_cap": self.beyond_cap,
            "worst_violation": self.worst,
            "pivots": spread(self.pivots),
            "active": spread(self.active),
            "cpu_ms": spread(self.times),
        }


def _active(problem: ghc.ControlProblem, acceleration: np.ndarray) -> int:
    """Bounds on accelerations and torques that are met with equality, to 1e-6 of their width."""
    count = 0
    torque = problem.mass_matrix @ acceleration + problem.bias
    for value, bounds in ((acceleration, problem.acceleration), (torque, problem.torque)):
        width = bounds.upper - bounds.lower
        gap = np.minimum(bounds.upper - value, value - bounds.lower)
        finite = np.isfinite(width)
        count += int((gap[finite] <= 1e-6 * width[finite]).sum())
    return count


def table(result: dict[str, Any]) -> str:
    """One line per formulation and kind of problem."""
    facts = result["facts"]
    head = [
        "formulation",
        "problems",
        *(status.name for status in SolutionStatus),
        "beyond cap",
    ]
    head += ["pivots of a step", "active bounds", "worst violation [rad/s^2, Nm]", "CPU [ms]"]
    lines = []
    for name, kinds in result["formulations"].items():
        for kind, row in kinds.items():
            cells = [
                *(name, kind, *(str(row["status"][s.name]) for s in SolutionStatus)),
                *(str(row["beyond_cap"]), shown_spread(row["pivots"])),
                *(shown_spread(row["active"]), shown(row["worst_violation"], ".1e")),
                shown_spread(row["cpu_ms"]),
            ]
            lines.append(cells)
    sizes = " and ".join(f"{count} with {joints}" for joints, count in facts["problems"].items())
    return (
        "Serial chains of revolute joints with alternating axes (links of 0.1 m and 0.5 kg), "
        f"{sizes} joints (seed {facts['seed']}): random postures at rest, random targets, random "
        "strict orders of 3 to 5 of the tasks end position, middle position, posture, end "
        "orientation and quarter position. Torque bounds are sized by the optimum without bounds: "
        "few or many joints break theirs; half of the problems bound accelerations as well. "
        f"x = 0 meets every bound. Cap: {facts['cap']} pivots per step. Median / p95 / max.\n\n"
        + markdown_table(head, lines)
    )
