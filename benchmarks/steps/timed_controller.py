"""A controller whose steps are timed by part."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter, thread_time
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.steps.states import DT, Segment, begin, with_torque_bound
from ghc_controller.types import Array

PARTS = {  # what a step reports of itself: the core makes some in one call, where nothing can wait
    "terms": "model, kinematics of the frames, task rows, references, priorities, bounds",
    "solve": "projectors, targets, metric, QPs, and the check of their answers",
    "rest": "output gate, result",
}
_OUTCOMES = ("qp_share", "solved_share", "active_bounds", "qps", "pivots")  # means per step


@dataclass(frozen=True, slots=True)
class Variant:
    """A formulation with a solver."""

    formulation: str
    solver: str

    @property
    def title(self) -> str:
        """Label in tables, without the default solver."""
        return self.formulation if self.solver == "daqp" else f"{self.formulation} ({self.solver})"


class TimedController:
    """One controller of one variant, and the times of its steps."""

    def __init__(self, robot: ghc.Robot, variant: Variant, bound: Array | None) -> None:
        """`bound` (n,) [Nm] is the torque bound about gravity, None without one."""
        self.variant = variant
        self.controller = make_controller(robot, variant, bound)
        self._samples: list[tuple[float, ...]] = []
        self._cpu_times: list[float] = []
        self._outcomes: list[tuple[float, ...]] = []  # of each step: see `watch`

    def watch(self, segment: Segment) -> None:
        """Step through a segment once, without timing, and record its events."""
        self._begin(segment)
        solver = self.controller.formulation.solver
        for state in segment.states:
            before = solver.qps
            result = self.controller.step(state)
            qps, pivots = solver.qps - before, solver.step_pivots
            active = len(self.controller.report().active_constraints)
            solved = result.status is ghc.StepStatus.SOLVED
            self._outcomes.append((result.solution.qp_solved, solved, active, qps, pivots))

    def follow(self, segment: Segment) -> None:
        """Time one step at each state of a segment."""
        self._begin(segment)
        for state in segment.states:
            self._step(state)

    def summary(self) -> dict[str, Any]:
        """Times [us] of all that was followed, and what happened in all that was watched."""
        table = np.array(self._samples) * 1e6
        total = table[:, -1]
        happened = np.mean(np.array(self._outcomes, dtype=float), axis=0)
        return {
            "formulation": self.variant.formulation,
            "solver": self.variant.solver,
            "steps": len(total),
            "median_us": _rounded(np.median(total)),
            "p99_us": _rounded(np.percentile(total, 99.0)),
            "mean_us": _rounded(np.mean(total)),
            "cpu_median_us": _rounded(np.median(self._cpu_times) * 1e6),
            "parts_us": {part: _rounded(np.median(table[:, i])) for i, part in enumerate(PARTS)},
            **dict(zip(_OUTCOMES, map(_rounded, happened), strict=True)),
        }

    def _begin(self, segment: Segment) -> None:
        begin(self.controller, segment.goals)
        self.controller.observe(segment.states[0])

    def _step(self, state: ghc.RobotState) -> None:
        cpu_start, start = thread_time(), perf_counter()
        result = self.controller.step(state)
        total = perf_counter() - start
        self._cpu_times.append(thread_time() - cpu_start)
        rest = total - result.time_terms - result.time_solve
        self._samples.append((result.time_terms, result.time_solve, rest, total))


def make_controller(robot: ghc.Robot, variant: Variant, bound: Array | None) -> ghc.Controller:
    """A warm controller without torque rate limit, as in the paper's experiments."""
    settings = ghc.Settings(
        formulation=variant.formulation,
        qp_solver=variant.solver,
        control_dt=DT,
        torque_rate_limit=0.0,
    )
    return ghc.Controller(robot if bound is None else with_torque_bound(robot, bound), settings)


def _rounded(value: Any) -> float:
    return round(float(value), 2)
