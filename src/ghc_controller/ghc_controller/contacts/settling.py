"""The answer of a step in which a contact comes on, with forces that do not jump in the next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ghc_controller.contacts.contact_set import ContactSet
from ghc_controller.formulations import (
    ContactRows,
    ControlProblem,
    Formulation,
    Solution,
    SolutionStatus,
)

_FURTHER_SOLVES = 3  # at most, in a step in which a contact comes on
_SETTLED = 1e-2  # [Nm] change of torque between two of them that ends it


def solve_settled(
    formulation: Formulation,
    problem: ControlProblem,
    contacts: ContactSet,
    active: tuple[bool, ...],
    rows: Callable[[], ContactRows | None],
) -> Solution:
    """Solve, and again where a contact has just come on: its cost expands about forces of before.

    Args:
        contacts: remembers the forces for the next step.
        active: (contacts,) which of them are on.
        rows: those of `problem.contacts` anew, with the forces that were remembered last.
    """
    name = problem.not_finite()
    if name:
        return Solution.without_answer(problem, f"{name} of the control problem is not finite")
    solution = formulation.solve(problem)
    contacts.remember(active, solution.force)
    if contacts.knows_forces(active):
        return solution
    for _ in range(_FURTHER_SOLVES):
        if solution.status is SolutionStatus.FAILED:
            break
        contacts.advance()
        capped = formulation.solver.counts["capped"]
        again = formulation.solve(replace(problem, contacts=rows()))
        if again.status is SolutionStatus.FAILED or formulation.solver.counts["capped"] > capped:
            break  # the answer before it is complete
        contacts.remember(active, again.force)
        change, solution = np.abs(again.torque - solution.torque).max(), again
        if change < _SETTLED:
            break
    return solution
