"""The interface of a QP solver and its budget."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

from ghc_controller.core import Clock
from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.residuals import Residuals, residuals
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import AT_LEAST_ONE, POSITIVE
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class SolverSettings:
    """Tolerance and effort of a solve, the same words for every solver.

    Effort is a count, so that an answer never depends on the machine; where time is real, no
    further level and no further QP of a control step begins after a share of the control period.
    """

    tolerance: float = declared(
        "largest primal and dual residual, in the QP's own scale",
        1e-9,
        unit="-",
        domain=POSITIVE,
        name="qp_tolerance",
    )
    max_pivots: int = declared(
        "of each active-set solver per QP", 200, unit="-", domain=AT_LEAST_ONE
    )
    max_iterations: int = declared(
        "of ProxQP per QP: outer ones, each with at most 10 inner ones",
        200,
        unit="-",
        domain=AT_LEAST_ONE,
    )
    max_step_pivots: int = declared(
        "of all QPs of a control step together", 2000, unit="-", domain=AT_LEAST_ONE
    )
    step_time_share: float = declared(
        "of the control period, after which no further level and no further QP of a control step "
        "begins; in lockstep, where time is simulated, pivots alone count",
        0.5,
        unit="-",
        domain=POSITIVE,
    )

    def __post_init__(self) -> None:
        """Raise InvalidValue for a number out of range."""
        check(self)


class QpSolver(ABC):
    """Solves one QP after the other; sizes may change between calls.

    `counts` adds up by name: `second_solver` QPs that were handed to the second solver, `capped`
    QPs that ended at a cap or were not begun since the budget was spent, `not_finite` QPs that
    were rejected, `late` control steps whose time was over before they were solved.

    Attributes:
        clock: of the time that a control step may take; None where only pivots count.
        step_time: [s] that it may take, from `start_clock` on.
        end: [s] of the clock, when it has to end.
    """

    name: str
    lets_core_solve = False  # whether the compiled core may solve QPs before this solver
    clock: Clock | None = None
    step_time = 0.0
    end = math.inf

    def __init__(self, settings: SolverSettings) -> None:
        self.settings = settings
        self.counts = {"second_solver": 0, "capped": 0, "not_finite": 0, "late": 0}
        self._part_end = math.inf  # [s] of this part of the control step; inf outside of one
        self._late = False  # something of the control step was left out
        self._begun = False  # whether a QP of this part was: the first one always is
        self._budget: int | None = None  # None outside a control step
        self.step_pivots = 0  # of the last control step
        self.qps = 0  # solved since it was made, those of the core among them
        self._kept = 0  # pivots of it that are kept for later parts of the step

    @property
    def pivots_per_qp(self) -> int:
        """Largest number of pivots of one QP."""
        return self.settings.max_pivots

    def start_clock(self) -> None:
        """Let the time of a control step begin."""
        if self.clock is not None:
            self.end = self.clock.now() + self.step_time

    def begin_step(self) -> None:
        """Begin a control step: its QPs share `max_step_pivots`; outside each QP is capped."""
        self._budget, self._kept = self.settings.max_step_pivots, 0
        self._part_end, self._begun = self.end, False

    def begin_part(self, left: int) -> None:
        """Begin the first of `left` parts that share what is left of a control step."""
        self._begun = False
        if self._budget is not None:
            self._kept = self._budget * (left - 1) // left
            if self.clock is not None and left > 1:
                now = self.clock.now()
                self._part_end = now + max(self.end - now, 0.0) / left
            else:
                self._part_end = self.end

    def end_step(self) -> None:
        """End the control step: QPs solved after it have no common budget."""
        if self._budget is not None:
            self.step_pivots = self.settings.max_step_pivots - self._budget
        self._budget, self._kept = None, 0
        self.counts["late"] += self._late
        self._part_end, self._late = math.inf, False

    @property
    def part_end(self) -> float:
        """[s] of the clock, when this part of the control step has to end; inf outside of one."""
        return self._part_end

    @property
    def is_late(self) -> bool:
        """Whether the time of this part is over; then the step counts as late."""
        if self.clock is None or self.clock.now() < self._part_end:
            return False
        self._late = True
        return True

    def account(self, pivots: int, qps: int) -> None:
        """Count a whole control step that the core made by itself."""
        self.qps += qps
        self.step_pivots = pivots

    def reset(self) -> None:  # noqa: B027 (most solvers remember nothing)
        """Forget earlier problems: the next answers are those of a new solver."""

    @property
    def pivots_left(self) -> int:
        """What is left of this part of the control step; outside of one that of a QP."""
        return self.pivots_per_qp if self._budget is None else self._budget - self._kept

    @property
    def step_budget(self) -> int:
        """What is left of the control step, for parts that share it; -1 outside of one."""
        return -1 if self._budget is None else self._budget

    def spend(self, pivots: int, qps: int) -> None:
        """Count QPs, and take their pivots from what is left of the control step."""
        self.qps += qps
        if self._budget is not None:
            self._budget -= pivots

    def solve(self, problem: QpProblem) -> QpResult:
        """Solve; an infeasible problem is reported by `status`, without an exception."""
        return self.solve_checked(problem)[0]

    def solve_checked(
        self, problem: QpProblem, units: Array | None = None
    ) -> tuple[QpResult, Residuals]:
        """Solve, with the residuals of the answer (`units` as in `residuals`)."""
        name = problem.not_finite()
        if name:
            self.counts["not_finite"] += 1
            reason = f"{name} of the QP is not finite"
            result = QpResult.without_answer(problem, QpStatus.FAILED, reason)
            return result, residuals(problem, result, units)
        self.qps += 1
        result, check = self._solve_checked(problem, units)
        self.counts["capped"] += result.status is QpStatus.ITERATION_LIMIT
        return result, check

    def _solve_checked(
        self, problem: QpProblem, units: Array | None
    ) -> tuple[QpResult, Residuals]:
        """Solve a QP of finite numbers within the budget."""
        result = self.limited(problem, self)
        return result, residuals(problem, result, units)

    def limited(self, problem: QpProblem, solver: QpSolver) -> QpResult:
        """Answer of `solver` within the budget of this one."""
        limit = solver.pivots_per_qp
        if self._budget is not None:
            limit = min(limit, self.pivots_left)
            if limit <= 0:
                reason = "the pivots of this control step are spent"
                return QpResult.without_answer(problem, QpStatus.ITERATION_LIMIT, reason)
            if self._begun and self.is_late:
                reason = "the time of this control step is over"
                return QpResult.without_answer(problem, QpStatus.ITERATION_LIMIT, reason)
        self._begun = True
        result = solver.run(problem, limit)
        self.spend(max(result.iterations, 1), 0)  # each QP costs
        return result

    @abstractmethod
    def run(self, problem: QpProblem, limit: int) -> QpResult:
        """Solve a QP of finite numbers in at most `limit` pivots."""
