"""Badly scaled, rank-deficient, duplicated, near-singular and infeasible problems.

Problems: test/reference/hard_problems.py; v = 0. Accuracy is not asked for here, but honesty: no
answer SOLVED with a violated row, no exception, no more iterations than the cap. Violations are
computed anew from J, M and the bounds.
"""

from __future__ import annotations

import time
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

import ghc_controller as ghc
from benchmarks.problems.plain_problems import control_problem, rounded
from ghc_controller.formulations import make_formulation
from ghc_controller.qp import SolverSettings

if TYPE_CHECKING:
    from reference.plain import Plain

NAME = "hard_problems"
TITLE = "Badly scaled, rank-deficient, near-singular and infeasible problems"
FORMULATIONS = ("cascade", "hqp", "balanced")

DAMPING = 1e-2  # [-] w
VIOLATED = 1e-6  # [rad/s^2], [Nm], [N]
ITERATION_CAP = SolverSettings().max_step_pivots  # of all QPs of a step together
_INTERIOR = 1e-6  # [rad/s^2], [Nm], [N] margin from which a problem counts as feasible
_ALL, _QUICK = 1000, 50
_WORST = 5  # problems that are named


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Solve all problems by the formulations of these names."""
    from reference.feasibility import margin
    from reference.hard_problems import hard_problems

    settings = ghc.FormulationSettings(regularization=DAMPING)
    solvers = {name: make_formulation(name, settings) for name in formulations}
    records = {name: _Record() for name in formulations}
    count, feasible = _QUICK if quick else _ALL, 0
    for index, (kind, plain) in enumerate(hard_problems(count)):
        possible = margin(plain) > _INTERIOR
        feasible += possible
        for name, formulation in solvers.items():
            records[name].add(formulation, plain, f"{index}: {kind}", possible)
    facts = {
        "problems": count,
        "damping": DAMPING,
        "feasible_with_interior": feasible,
        "iteration_cap": ITERATION_CAP,
    }
    figures = {name: record.figures() for name, record in records.items()}
    return {"facts": facts, "formulations": figures}


class _Record:
    """Results of one formulation."""

    def __init__(self) -> None:
        self.status: Counter[str] = Counter()
        self.exceptions: Counter[str] = Counter()
        self.unsolved_feasible = self.beyond_cap = self.most_iterations = 0
        self.not_finite = 0
        self.slowest = 0.0  # [s]
        self.worst: list[tuple[float, str, str]] = []  # violation, row, problem

    def add(self, formulation: ghc.Formulation, plain: Plain, label: str, feasible: bool) -> None:
        """Solve one problem."""
        from reference.plain import violations

        formulation.solver.begin_step()
        start = time.perf_counter()
        try:
            solution = formulation.solve(control_problem(plain))
        except Exception as error:  # counted by kind, whatever it is
            self.exceptions[type(error).__name__] += 1
            return
        self.slowest = max(self.slowest, time.perf_counter() - start)
        self.status[solution.status.name] += 1
        used = ITERATION_CAP - formulation.solver.pivots_left
        self.most_iterations = max(self.most_iterations, used)
        self.beyond_cap += max(solution.iterations, used) > ITERATION_CAP
        if solution.status.name != "SOLVED":
            self.unsolved_feasible += feasible
            return
        if not np.all(np.isfinite(solution.acceleration)):
            self.not_finite += 1
            return
        missed = violations(plain, solution.acceleration, solution.force)._asdict()
        kind = max(missed, key=lambda key: missed[key])
        if missed[kind] > VIOLATED:
            self.worst.append((rounded(missed[kind]), kind, label))

    def figures(self) -> dict[str, Any]:
        worst = sorted(self.worst, reverse=True)
        return {
            "status": dict(self.status),
            "exceptions": dict(self.exceptions),
            "solved_with_violation": len(worst),
            "solved_not_finite": self.not_finite,
            "worst": [list(entry) for entry in worst[:_WORST]],
            "unsolved_though_feasible": self.unsolved_feasible,
            "beyond_cap": self.beyond_cap,
            "most_iterations": self.most_iterations,
            "slowest_ms": rounded(1e3 * self.slowest),
        }


def table(result: dict[str, Any]) -> str:
    """Markdown of a result of `run`."""
    facts = result["facts"]
    lines = [
        f"{facts['problems']} problems, {facts['feasible_with_interior']} of them with a "
        f"feasible point at least {_INTERIOR:.0e} away from all bounds (HiGHS). Damping "
        f"{facts['damping']}, cap {facts['iteration_cap']} iterations.",
        "",
        f"| formulation | status | exceptions | SOLVED, violation above {VIOLATED:.0e} | worst | "
        "not SOLVED though feasible | beyond cap | most iterations | slowest [ms] |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name, row in result["formulations"].items():
        worst = row["worst"][0] if row["worst"] else None
        columns = [
            name,
            ", ".join(f"{count} {word}" for word, count in row["status"].items()),
            str(sum(row["exceptions"].values())),
            str(row["solved_with_violation"] + row["solved_not_finite"]),
            "-" if worst is None else f"{worst[0]:.1e} ({worst[1]})",
            str(row["unsolved_though_feasible"]),
            str(row["beyond_cap"]),
            str(row["most_iterations"]),
            f"{row['slowest_ms']:.0f}",
        ]
        lines.append(f"| {' | '.join(columns)} |")
    return "\n".join(lines)
