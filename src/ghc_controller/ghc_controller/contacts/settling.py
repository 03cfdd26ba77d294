"""Repeated solves when a contact is activated, so that forces do not jump in the next step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ghc_controller.contacts.contact_set import ContactSet
from ghc_controller.formulations import Formulation
from ghc_controller.problem.control_problem import ContactRows, ControlProblem
from ghc_controller.problem.solution import Solution, SolutionStatus

_FURTHER_SOLVES = 3  # at most, in a step that activates a contact
_SETTLED = 1e-2  # [Nm] change of torque between two solves that ends the iteration


def solve_settled(
    formulation: Formulation,
    problem: ControlProblem,
    contacts: ContactSet,
    active: tuple[bool, ...],
    rows: Callable[[], ContactRows | None],
) -> Solution:
    """Solve; repeat if a contact was just activated, since its cost expands about past forces.

    Args:
        contacts: stores the forces for the next step.
        active: (contacts,) which of them are active.
        rows: recomputes those of `problem.contacts` with the forces stored last.
    """
    solution = formulation.answer(problem)
    contacts.remember(active, solution.force)
    if contacts.knows_forces(active):
        return solution
    for _ in range(_FURTHER_SOLVES):
        if solution.status is SolutionStatus.FAILED or formulation.solver.is_late:
            break
        contacts.advance()
        capped = formulation.solver.counts["capped"]
        again = formulation.solve(replace(problem, contacts=rows()))
        cut = formulation.solver.is_late or formulation.solver.counts["capped"] > capped
        if again.status is SolutionStatus.FAILED or cut:
            break  # the previous solution is complete
        contacts.remember(active, again.force)
        change, solution = np.abs(again.torque - solution.torque).max(), again
        if change < _SETTLED:
            break
    return solution
