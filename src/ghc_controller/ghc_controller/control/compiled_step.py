"""A step in one call of the core, where no part of it is written in Python."""

from __future__ import annotations

from typing import Any

from ghc_controller.control.answer import Answer
from ghc_controller.control.step_in_parts import Controller
from ghc_controller.core import Cascade as OrderCore
from ghc_controller.core import Step
from ghc_controller.formulations import Formulation
from ghc_controller.formulations.cascade.cascade import Cascade
from ghc_controller.problem.solution import NO_FORCE, Solution, SolutionStatus
from ghc_controller.report.report import StepResult, StepStatus
from ghc_controller.report.reporting import Limits
from ghc_controller.safety.torque_gate import COUNTED_EXCESS
from ghc_controller.tasks.law import tracking
from ghc_controller.types import Array, RobotState

_ANSWER = (StepResult, Solution, StepStatus.SOLVED, SolutionStatus.SOLVED, NO_FORCE)
_Found = tuple[int, int, int, bool, bool, float, float, float, Array | None, Any]


class CompiledStep:
    """The call, and what of its arguments changes with requests only.

    What Python adds to a step, such as a task with a `measure` of its own, contacts that are on,
    obstacles or a ramp that is paced by its torques, makes it a step in parts: `takes` says so.

    Where nothing but the state, and the shares of a ramp, are others than at the step before,
    `again` makes the step and its result in one call, and nothing of Python is done anew.
    """

    def __init__(self, controller: Controller) -> None:
        """Take the parts of a controller as they are at each step."""
        self._controller = controller
        self._formulation: Formulation | None = None  # that the following were made for
        self._solver = controller.formulation.solver
        self._core: Step | None = None
        self._rests = False  # whether `again` may be asked: the last step left nothing open
        self._settings = controller.settings  # of it
        self._effort = controller.settings.solving  # of it
        self._matrices: tuple[Array, ...] = ()
        self._orders: tuple[OrderCore | None, ...] = ()
        self._limits: Limits | None = None
        self._stack, self._references = controller.stack, controller.references
        self._constraints, self._schedule = controller.constraints, controller.priorities
        self._contacts, self._sensed = controller.force_bounds, controller.sensing.is_used
        self._anchor, self._moves = controller.output.anchor, controller.tuning.moves
        model = self._model = controller.model
        self._exerted = model.exerted
        self._shapes = (model.nq,), (model.nv,)

    def reset(self) -> None:
        """Forget the orders in use: their active sets are those of the run before."""
        self._matrices, self._rests = (), False

    def again(self, state: RobotState) -> StepResult | _Found | None:
        """The step where nothing but the state, and the shares of a ramp, changed since the last.

        Returns:
            What the core found where it left a part open: `answer` finishes it. None where
            something changed: a request, a preview, a setting, a hold, the end of a ramp.
        """
        # Attributes where a property would do: calls of Python are a good part of a short step.
        time, references = state.time, self._references
        solver, controller = self._solver, self._controller
        if not (
            self._rests
            and references.rest_from <= time < references.rest_until
            and controller.formulation is self._formulation
            and controller.settings is self._settings
            and solver.settings is self._effort
            and not self._moves
            and not self._exerted
            and self._stack.law is tracking
            and self._contacts.plan is None
            and self._constraints.rests
        ):
            return None
        mixture, core = self._schedule.glide(time), self._core
        if mixture is None or mixture[0] is not self._matrices or core is None:
            return None
        found: StepResult | _Found | None = core.again(
            time, state.q, state.v, mixture[1], solver.step_time
        )
        if type(found) is StepResult:
            solution = found[3]  # its parts by their places, which names would take longer for
            if solution[4]:  # qp_solved
                solver.account(solution[7], core.qps)  # iterations
            else:
                solver.step_pivots = 0
        elif found is not None:
            self._rests = False
            solver.end = core.end
        return found

    def takes(self, state: RobotState) -> bool:
        """Whether the core makes the whole step in answer to a state."""
        controller, self._rests = self._controller, False
        if controller.formulation is not self._formulation:
            self._take(controller.formulation)
        return (
            self._core is not None
            and self._stack.is_compiled
            and self._references.has_begun
            and not self._contacts.some_active
            and not self._constraints.has_rows
            and not self._schedule.is_paced_at(state.time)
            and not self._sensed
            and not self._exerted
            and (state.q.shape, state.v.shape) == self._shapes
        )

    def _take(self, formulation: Formulation) -> None:
        """Make the call for a formulation; there is none where Python has a part in each step."""
        self._formulation, self._core, self._matrices = formulation, None, ()
        controller = self._controller
        boxes = controller.constraints.cores
        if boxes is None or not isinstance(formulation, Cascade) or not formulation.is_compiled:
            return
        stack, gate = controller.stack.core_of(controller.model), controller.output.gate.core
        anchor = controller.output.anchor.core
        self._core = Step(stack, *boxes, gate, formulation.core, anchor, _ANSWER)
        self._solver = formulation.solver

    def answer(self, state: RobotState, found: Any = None) -> Answer:
        """Answer a state that it `takes`; `found`: by `again`, which left a part open."""
        core, time, constraints = self._core, state.time, self._constraints
        assert core is not None
        controller = self._controller
        solver = self._solver
        events = self._schedule.advance(time)
        self._stack.follow(self._references.targets(time))
        if self._anchor.follows(time):
            before = self._anchor.at(time)
        else:  # the first step, or the one after a hold: from what holds the robot
            self._model.update(state.q, state.v)
            before = controller.output.before(state)
        constraints.prepare(time)
        matrices, shares = self._schedule.mixture
        if matrices is not self._matrices:
            self._use(matrices)
        if found is None:
            found = core.run(
                state.q,
                state.v,
                before,
                time,
                controller.settings.control_dt,
                self._orders,
                shares,
                solver.lets_core_solve,
                solver.pivots_per_qp,
                solver.settings.max_step_pivots,
                solver.clock,
                solver.end,
            )
        done, pivots, qps, gave_way, within, excess, terms, solve, gated, solution = found
        constraints.note(gave_way)
        limits, torque = self._limits_at(time), None
        if within and solution is not None:
            solver.account(pivots, qps)
            if gated is not None and excess <= COUNTED_EXCESS:
                torque = gated
                self._anchor.sent(torque, time)
        else:
            rest: tuple[Any, ...] = ()
            if solution is not None:
                x, force, tau, _, qp_solved, violation, _, iterations = solution[:8]
                rest = (x, force, tau, violation, iterations, qp_solved, within)
            solution = self._finish(limits, done, pivots, qps, rest)
        self._rests = (
            torque is not None
            and not gave_way
            and constraints.rests
            and self._contacts.plan is None
        )
        self._settings, self._effort = controller.settings, solver.settings
        return Answer(events, before, limits, None, solution, torque, terms, solve)

    def _finish(self, limits: Limits, *found: Any) -> Solution:
        """The solution where the core left a part of it open, as `Cascade.finish` wants it."""
        controller, formulation = self._controller, self._formulation
        assert isinstance(formulation, Cascade)
        problem = controller.views.of(self._schedule.in_force, limits, False)
        formulation.solver.begin_step()
        solution = formulation.finish(problem, *found)
        formulation.solver.end_step()
        return solution

    def _use(self, matrices: tuple[Array, ...]) -> None:
        formulation = self._formulation
        assert isinstance(formulation, Cascade)
        self._orders = formulation.cores_of(matrices, self._stack.starts)
        self._matrices = matrices

    def _limits_at(self, time: float) -> Limits:
        bounds = self._contacts.at(time)  # the same object without a plan
        if self._limits is None or self._limits.normal_bounds is not bounds:
            self._limits = Limits(self._constraints.boxes, None, bounds, None)
        return self._limits
