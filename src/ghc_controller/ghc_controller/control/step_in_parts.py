"""A step part by part, where Python has a part in it: model, tasks, limits, formulation."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter
from typing import Protocol

from ghc_controller.constraints import ConstraintSet
from ghc_controller.contacts import (
    BoundsInForce,
    ContactSensing,
    ContactSet,
    NormalBounds,
    solve_settled,
)
from ghc_controller.control.answer import Answer
from ghc_controller.control.problem_views import ProblemViews
from ghc_controller.control.torque_output import TorqueOutput
from ghc_controller.control.tuning import Tuning
from ghc_controller.formulations import Formulation
from ghc_controller.hierarchy import TransitionSchedule
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.report.reporting import Limits
from ghc_controller.settings import Settings
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array, RobotState


class Controller(Protocol):
    """What is used of a controller."""

    model: RobotModel
    references: ReferenceSchedule
    force_references: ReferenceSchedule
    stack: TaskStack
    contacts: ContactSet
    constraints: ConstraintSet
    force_bounds: BoundsInForce
    sensing: ContactSensing
    formulation: Formulation
    priorities: TransitionSchedule
    settings: Settings
    output: TorqueOutput
    tuning: Tuning
    views: ProblemViews
    stays: bool


class StepInParts:
    """Makes a step of any tasks, constraints, contacts and formulation."""

    def __init__(self, controller: Controller) -> None:
        """Take the parts of a controller as they are at each step."""
        self._controller = controller

    def answer(self, state: RobotState) -> Answer:
        """Answer a state."""
        begin = perf_counter()
        controller, time = self._controller, state.time
        model, schedule = controller.model, controller.priorities
        model.update(state.q, state.v)
        self.begin_references()
        events = schedule.advance(time)
        priorities = schedule.pace(time, controller.settings.control_dt)
        controller.stack.update(model, state, controller.references.targets(time))
        before = controller.output.before(state)
        mixed = priorities.candidates if controller.formulation.answers_candidates else ()
        controller.contacts.begin(time, mixed)
        limits = self._limits(state, before)
        after_terms = perf_counter()
        formulation, bounds = controller.formulation, limits.normal_bounds
        formulation.solver.begin_step()
        problem = controller.views.of(
            priorities, limits, controller.settings.optimization.second_order
        )
        solution, solved = solve_settled(
            formulation,
            problem,
            controller.contacts,
            bounds.active,
            lambda: controller.constraints.on_forces(self.contact_rows(bounds, time)),
        )
        formulation.solver.end_step()
        if solved is not problem:
            limits = replace(limits, contact_rows=solved.contacts)
        end = perf_counter()
        times = after_terms - begin, end - after_terms
        return Answer(events, before, limits, priorities, solution, None, *times)

    def begin_references(self) -> None:
        """Fix the targets of tasks without a reference, where that is still to be done."""
        controller = self._controller
        if not controller.references.has_begun:
            controller.references.begin(controller.model, controller.stays)
            controller.force_references.begin(controller.model)

    def force_bounds(self, state: RobotState) -> NormalBounds:
        """Bounds on contact forces, with those contacts on that are felt to be."""
        controller = self._controller
        planned = controller.force_bounds.at(state.time)
        return controller.sensing.confirm(planned, state.time, state.wrenches)

    def contact_rows(self, bounds: NormalBounds, time: float) -> ContactRows | None:
        """Rows of the contacts that are on at the last `model.update`, bounds on forces aside."""
        controller = self._controller
        return controller.contacts.rows(
            controller.model, bounds, controller.force_references, time
        )

    def _limits(self, state: RobotState, before: Array) -> Limits:
        controller = self._controller
        constraints = controller.constraints
        bounds = self.force_bounds(state)
        contacts = self.contact_rows(bounds, state.time)
        boxes = constraints.update(
            controller.model,
            controller.model.dynamics,
            state,
            before,
            controller.settings.control_dt,
            contacts,
        )
        return Limits(boxes, constraints.on_forces(contacts), bounds, constraints.rows)
