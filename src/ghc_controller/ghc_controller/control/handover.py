"""From one formulation to another while the robot moves: the answers of both, blended."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ghc_controller.formulations.cascade.blend import blend
from ghc_controller.formulations.formulation import Formulation
from ghc_controller.hierarchy.priorities import Candidate, Priorities
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.types import Array, Starts


class Handover(Formulation):
    """(1 - share) old + share new: it meets every convex bound that both answers meet.

    Both solve every step, so a step costs their sum while it lasts. Where one has no answer that
    of the other counts alone.

    Attributes:
        share: [-] of the new formulation, in [0, 1].
    """

    def __init__(self, old: Formulation, new: Formulation) -> None:
        super().__init__(new.settings, new.solver)
        self.old, self.new, self.share = old, new, 0.0
        self.name, self.projector = new.name, new.projector

    def retune(self, **numbers: Any) -> None:
        """See Formulation.retune: a number that both have changes in both."""
        self.old.retune(**numbers)
        self.new.retune(**numbers)
        self.settings = self.new.settings

    @property
    def answers_candidates(self) -> bool:
        """See Formulation: as long as one of both does."""
        return self.old.answers_candidates or self.new.answers_candidates

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        answers = [part.solve(problem) for part in (self.old, self.new)]
        worked = [one for one in answers if one.status is not SolutionStatus.FAILED]
        if len(worked) == 1:
            return worked[0]
        alpha = problem.priorities.alpha
        shares = (1.0 - self.share, self.share)
        mixture = Priorities(alpha, tuple(Candidate(alpha, share) for share in shares))
        return blend(answers, mixture)._replace(of_candidates=_forces(answers, shares))

    def reset(self) -> None:
        """See Formulation.reset."""
        self.old.reset()
        self.new.reset()

    def solvability(self, jacobian: Array, starts: Starts) -> Solvability:
        """What both formulations ask for, as a margin over what each expects at least."""
        old, new = (part.solvability(jacobian, starts) for part in (self.old, self.new))
        return Solvability(
            lambda alpha: min(old.measure(alpha) - old.least, new.measure(alpha) - new.least),
            0.0,
            f"'{self.old.name}' hands over to '{self.new.name}', and one of them would have no "
            "answer: margin",
            "wait until the change of formulation has ended, or give an order of tasks",
            old.along_ramp or new.along_ramp,
        )


def _forces(answers: Sequence[Solution], shares: Sequence[float]) -> tuple[Array, ...]:
    """Forces (c,) of each candidate of a mixture, of those answers that have them."""
    given = [
        (share, answer.of_candidates)
        for share, answer in zip(shares, answers, strict=True)
        if answer.of_candidates
    ]
    if len(given) < len(answers):  # one of both does not look at candidates
        return given[0][1] if given else ()
    (first, one), (last, other) = given
    return tuple(first * a + last * b for a, b in zip(one, other, strict=True))
