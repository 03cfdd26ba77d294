"""Repeated solves when a contact or an order enters: no jump of forces in the next step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ghc_controller.contacts.contact_set import ContactSet
from ghc_controller.formulations import Formulation
from ghc_controller.hierarchy.ramp import PacedPriorities
from ghc_controller.problem.control_problem import ContactRows, ControlProblem
from ghc_controller.problem.solution import Solution, SolutionStatus

_FURTHER_SOLVES = 3  # at most, in a step that activates a contact or an order
_FELT = 1e-3  # [-] share of an order that enters from which on its forces settle at once
_SETTLED = 1e-2  # [Nm] change of torque between two solves that ends the iteration


def solve_settled(
    formulation: Formulation,
    problem: ControlProblem,
    contacts: ContactSet,
    active: tuple[bool, ...],
    rows: Callable[[], ContactRows | None],
) -> tuple[Solution, ControlProblem]:
    """Solve; repeat if a contact or an order was just activated: it knows no past forces.

    The cost on forces expands about them. An order that enters a mixture expands about those of
    the blend at first; with a share below 1e-3, as in the first step of a cosine, the steps to
    come are enough. A budget of torque rate needs the settled answer whatever the share.

    Args:
        contacts: stores the forces for the next step.
        active: (contacts,) which of them are active.
        rows: recomputes those of `problem.contacts` with the forces stored last.

    Returns:
        The solution, and the problem that it solves: the given one, or its last repetition.
    """
    solution = formulation.answer(problem)
    contacts.remember(active, solution.force, solution.of_candidates)
    if contacts.knows_forces(active) and not _enters(problem, solution, contacts):
        return solution, problem
    for _ in range(_FURTHER_SOLVES):
        if solution.status is SolutionStatus.FAILED or formulation.solver.is_late:
            break
        contacts.advance()
        capped = formulation.solver.counts["capped"]
        expanded = replace(problem, contacts=rows())
        again = formulation.solve(expanded)
        cut = formulation.solver.is_late or formulation.solver.counts["capped"] > capped
        if again.status is SolutionStatus.FAILED or cut:
            break  # the previous solution is complete
        contacts.remember(active, again.force, again.of_candidates)
        change = np.abs(again.torque - solution.torque).max()
        solution, problem = again, expanded
        if change < _SETTLED:
            break
    return solution, problem


def _enters(problem: ControlProblem, solution: Solution, contacts: ContactSet) -> bool:
    """Whether the answer of an order that has no forces of its own yet is felt in the blend."""
    entering = contacts.entering() if solution.of_candidates else []
    if not entering or isinstance(problem.priorities, PacedPriorities):
        return bool(entering)
    return any(problem.priorities.candidates[place].share >= _FELT for place in entering)
