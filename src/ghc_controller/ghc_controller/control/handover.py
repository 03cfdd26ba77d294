"""From one formulation to another while the robot moves: the answers of both, blended."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ghc_controller.formulations.cascade.blend import blend
from ghc_controller.formulations.formulation import Formulation
from ghc_controller.hierarchy.priorities import Candidate, Priorities
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.types import Array, Bounds, Starts

FADE = 0.2  # [s] in which the share of a formulation without an answer goes from 1 to 0


class _Difference(NamedTuple):
    """By how much the answer of the new formulation differs from that of the old one."""

    acceleration: Array  # (n,)
    force: Array  # (c,)
    torque: Array  # (a,) [Nm]

    @classmethod
    def between(cls, old: Solution, new: Solution) -> _Difference:
        """Of two answers to one problem; fresh arrays."""
        parts = (new.acceleration - old.acceleration, new.force - old.force)
        return cls(*parts, new.torque - old.torque)

    def added(self, answer: Solution, sign: float, box: Bounds) -> Solution:
        """An answer and `sign` times this, its torque within a box (a,) [Nm]."""
        torque = answer.torque + sign * self.torque
        return answer._replace(
            acceleration=answer.acceleration + sign * self.acceleration,
            force=answer.force + sign * self.force,
            torque=np.minimum(np.maximum(torque, box.lower), box.upper),
            iterations=0,
        )


class Handover(Formulation):
    """(1 - share) old + share new: it meets every convex bound that both answers meet.

    Both solve every step, so a step costs their sum while it lasts. Where one has no answer, the
    answer of the other plus their last difference takes its place, within the torque box, and its
    share fades; afterwards the share comes back as slowly. So a few steps without an answer
    are no jump of torque. One that never had an answer does not count at all.

    Attributes:
        share: [-] of the new formulation as planned, in [0, 1].
        in_force: [-] the one of the last step: another one where an answer was missing.
    """

    def __init__(self, old: Formulation, new: Formulation, control_dt: float) -> None:
        """Nothing handed over yet; `control_dt` is the control period [s]."""
        super().__init__(new.settings, new.solver)
        self.old, self.new, self.share, self.in_force = old, new, 0.0, 0.0
        self.name, self.projector = new.name, new.projector
        self._most = control_dt / FADE  # [-] by which the share differs more in a step
        self._apart = 0.0  # [-] in_force - share
        self._differ: _Difference | None = None  # at the last step that had both answers

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
        missing = [one.status is SolutionStatus.FAILED for one in answers]
        if all(missing):
            self._differ = None
            return answers[0]
        if any(missing):
            worked = answers[missing.index(False)]
            differ = self._differ
            if differ is None or differ.force.shape != worked.force.shape:
                self._differ, self.in_force = None, float(missing[0])
                self._apart = self.in_force - self.share
                return worked
            sign = 1.0 if missing[1] else -1.0
            answers[missing.index(True)] = differ.added(worked, sign, problem.torque)
        else:
            self._differ = _Difference.between(*answers)
        self._move(missing)
        alpha = problem.priorities.alpha
        shares = (1.0 - self.in_force, self.in_force)
        mixture = Priorities(alpha, tuple(Candidate(alpha, share) for share in shares))
        return blend(answers, mixture)._replace(of_candidates=_forces(answers, shares))

    def _move(self, missing: Sequence[bool]) -> None:
        """Share in force of this step: towards the answer there is, else towards the planned."""
        if any(missing):
            goal = float(missing[0])
            self.in_force += min(max(goal - self.in_force, -self._most), self._most)
            self._apart = self.in_force - self.share
        else:
            self._apart -= min(max(self._apart, -self._most), self._most)
            self.in_force = self.share + self._apart

    @property
    def is_settled(self) -> bool:
        """Whether the share is the planned one, or that of the only one with an answer."""
        return self._apart == 0.0 or self.in_force in (0.0, 1.0)

    def reset(self) -> None:
        """See Formulation.reset."""
        self._differ, self._apart = None, 0.0
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
