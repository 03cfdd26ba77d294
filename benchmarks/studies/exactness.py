"""Exact levels under bounds: formulations against an independent hard cascade.

Problems: test/reference/problems.py, where their conditioning is stated; v = 0. Excess of a level:
(|J_l x - b_l| - the reference's) / |b_l|, signed. It says something of level l only where the
levels above agree with the reference, so that level 2 is also given for those problems alone.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING, Any

import numpy as np

import ghc_controller as ghc
from benchmarks.problems.plain_problems import cells, control_problem, rounded, spread
from ghc_controller.formulations import make_formulation

if TYPE_CHECKING:
    from reference.hard_cascade import Reference
    from reference.plain import Plain

NAME = "exactness"
TITLE = "Exact levels under active bounds"
FORMULATIONS = ("cascade", "hqp", "balanced")

DAMPING = 1e-2  # [-] w of formulations and reference
AGREES = 1e-6  # [-] of |b|, difference at level 1 that still counts as agreement
_ALL, _QUICK = 600, 30
_LEVELS = ("1", "2", "2 where 1 agrees", "3+")
_GROUPS = ("fixed base", "in contact")


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Solve all problems by the reference and by the formulations of these names."""
    from reference.hard_cascade import hard_cascade, kept_damping
    from reference.problems import MASS_CONDITION, SINGULAR_VALUES, well_scaled

    settings = ghc.FormulationSettings(regularization=DAMPING)
    solvers = {name: make_formulation(name, settings) for name in formulations}
    kept = kept_damping(DAMPING)  # each is compared under its own damping
    rules = {name: kept if name == "cascade" else DAMPING for name in formulations}
    rules["reference"] = DAMPING
    records = {(name, group): _Record() for name in formulations for group in _GROUPS}
    active, kkt, violation = 0, 0.0, 0.0
    count = _QUICK if quick else _ALL
    for plain in well_scaled(count):
        references = {rule: hard_cascade(plain, rule) for rule in set(rules.values())}
        reference = references[DAMPING]
        active += any(reference.active[:2])
        kkt, violation = max(kkt, reference.kkt), max(violation, reference.violation)
        group = _GROUPS[plain.contacts is not None]
        for name, formulation in solvers.items():
            records[name, group].add(formulation, plain, references[rules[name]])
    facts = {
        "problems": count,
        "damping": DAMPING,
        "singular_values": list(SINGULAR_VALUES),
        "mass_condition": MASS_CONDITION,
        "active_at_level_1_or_2": active,
        "reference_kkt_max": kkt,
        "reference_violation_max": violation,
    }
    figures = {
        name: {group: records[name, group].figures() for group in _GROUPS} for name in formulations
    }
    return {"facts": facts, "formulations": figures}


class _Record:
    """Results of one formulation on one group of problems."""

    def __init__(self) -> None:
        self.status: Counter[str] = Counter()
        self.excess: defaultdict[str, list[float]] = defaultdict(list)
        self.violation: defaultdict[str, float] = defaultdict(float)

    def add(self, formulation: ghc.Formulation, plain: Plain, reference: Reference) -> None:
        """Solve one problem."""
        from reference.plain import violations

        try:
            solution = formulation.solve(control_problem(plain))
        except Exception as error:  # counted by kind, whatever it is
            self.status[type(error).__name__] += 1
            return
        self.status[solution.status.name] += 1
        if solution.status.name != "SOLVED":
            return
        x = solution.acceleration
        for kind, value in violations(plain, x, solution.force)._asdict().items():
            self.violation[kind] = max(self.violation[kind], value)
        excess = [
            (np.linalg.norm(level.jacobian @ x - level.target) - miss)
            / np.linalg.norm(level.target)
            for level, miss in zip(plain.levels, reference.residuals, strict=True)
        ]
        self.excess["1"].append(excess[0])
        self.excess["2"].append(excess[1])
        self.excess["3+"].append(max(excess[2:]))
        if abs(excess[0]) <= AGREES:
            self.excess["2 where 1 agrees"].append(excess[1])

    def figures(self) -> dict[str, Any]:
        return {
            "status": dict(self.status),
            "excess": {level: spread(values) for level, values in self.excess.items()},
            "level_1_agrees": len(self.excess["2 where 1 agrees"]),
            "violation": {kind: rounded(value) for kind, value in self.violation.items()},
        }


def table(result: dict[str, Any]) -> str:
    """Markdown of a result of `run`."""
    facts = result["facts"]
    low, high = facts["singular_values"]
    lines = [
        f"{facts['problems']} random problems, singular values of tasks within "
        f"[{low}, {high}], condition of M at most {facts['mass_condition']:.0f}, "
        f"w = {facts['damping']}, v = 0. A bound is active at level 1 or 2 in "
        f"{facts['active_at_level_1_or_2']}. Excess over an independent hard cascade with the "
        "damping of each formulation, in units of abs(b): median / p95 / max. KKT residual of "
        f"the reference at most {facts['reference_kkt_max']:.0e}, its violation "
        f"{facts['reference_violation_max']:.0e}.",
        "",
        "| formulation | problems | status | level 1 | level 2 | level 2 where level 1 agrees | "
        "level 3+ | largest violation [rad/s^2, Nm, N] |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, groups in result["formulations"].items():
        for group, row in groups.items():
            status = ", ".join(f"{count} {word}" for word, count in row["status"].items())
            levels = [cells(row["excess"].get(key)) for key in _LEVELS]
            worst = max(row["violation"].values(), default=0.0)
            columns = [name, group, status, *levels, f"{worst:.0e}"]
            lines.append(f"| {' | '.join(columns)} |")
    return "\n".join(lines)
