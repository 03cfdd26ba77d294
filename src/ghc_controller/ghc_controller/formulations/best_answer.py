"""What a descent through levels has so far: the best answer above, and what gave way there."""

from __future__ import annotations

from ghc_controller.formulations.cascade.level_answers import keeps_bounds
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution, SolutionStatus


class BestAnswer:
    """Takes the answers of the levels in their order, and keeps the last one that counts.

    A level below is constrained by the answer above, so what gave way is what the first level
    gave. An answer that keeps fewer bounds than that (no pivot was left, or rounding) ends the
    descent: the one above stays, and the levels from there on count as dropped.
    """

    def __init__(self, problem: ControlProblem, levels: int) -> None:
        """Begin a descent through `levels` levels of `problem`."""
        self._problem = problem
        self._levels = levels
        self._answer: Solution | None = None

    @property
    def is_empty(self) -> bool:
        """Whether no level was answered yet."""
        return self._answer is None

    @property
    def answer(self) -> Solution:
        """The answer of the last level that counts; there is one after the first `accept`."""
        assert self._answer is not None
        return self._answer

    def leave_out(self, depth: int) -> None:
        """End the descent before level `depth`, since its time is over."""
        self._answer = self.answer._replace(levels_dropped=self._levels - depth)

    def accept(self, depth: int, found: Solution) -> bool:
        """Take the answer of level `depth` (0 is the first); whether the descent goes on."""
        above = self._answer
        if above is None:
            self._answer = found
            return found.status is not SolutionStatus.FAILED
        if not keeps_bounds(self._problem, above.status, found):
            self._answer = above._replace(levels_dropped=self._levels - depth)
            return False
        self._answer = found._replace(
            status=max(above.status, found.status, key=lambda status: status.value),
            qp_solved=above.qp_solved or found.qp_solved,
            iterations=above.iterations + found.iterations,
            acceleration_slack=above.acceleration_slack,
            rows_slack=above.rows_slack,
            force_slack=above.force_slack,
            rate_gave_way=above.rate_gave_way,
            reason=above.reason,
        )
        return True
