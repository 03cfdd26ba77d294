"""The controller: robot state in, torque out; no ROS, no clock of its own."""

from __future__ import annotations

from copy import deepcopy
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.constraints.obstacle import ObstacleDistance
from ghc_controller.contacts import (
    BoundsInForce,
    ContactSensing,
    ContactSet,
    NormalBounds,
    solve_settled,
)
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.formulations import FORMULATIONS, make_formulation
from ghc_controller.hierarchy import (
    Solvability,
    Transition,
    TransitionEvent,
    TransitionSchedule,
    generalized_projectors,
    matrix_from_hierarchy,
    smallest_singular_value,
)
from ghc_controller.problem.control_problem import ContactRows, ControlProblem
from ghc_controller.problem.reduction import kept_by_contacts
from ghc_controller.qp import make_solver
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.report.report import ObstacleReport, Report, StepResult, StepStatus
from ghc_controller.report.reporting import (
    Limits,
    contact_report,
    load_report,
    make_report,
    task_reports,
)
from ghc_controller.robot.library import load_robot
from ghc_controller.robot.robot import Robot
from ghc_controller.safety.braking import braking_torque
from ghc_controller.safety.gate import OutputGate
from ghc_controller.safety.rate_anchor import FIRST_SHARE, RateAnchor
from ghc_controller.settings import Settings, make_constraints
from ghc_controller.tasks.second_order import second_order_terms
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array, Dynamics, RobotState
from ghc_controller.warm_up import warm_up


class Controller:
    """Generalized hierarchical control of one robot.

    Each `step` goes one way: state, tasks and constraints, priority matrix, formulation, output
    gate, torque. References and transitions carry the time at which they apply and may be given
    long before.

    Raises:
        GhcError: from the robot's file or the settings, with what was given and expected.
    """

    def __init__(self, robot: Robot, settings: Settings | None = None) -> None:
        self.robot = robot
        self.settings = settings or Settings()
        self.model = robot.model
        self.references = ReferenceSchedule(robot.tasks)
        self.stack = TaskStack(robot.tasks, self.model.nv)
        self.constraints = make_constraints(robot, self.settings)
        self.contacts = ContactSet(
            robot.contacts, self.model.weight if self.model.floating_base else 0.0
        )
        self.force_bounds = BoundsInForce(robot.contacts)
        self.sensing = ContactSensing(robot.contacts, self.force_bounds)
        self.obstacles = ObstacleDistance(self.model, self.settings.obstacle_horizon)
        self.force_references = ReferenceSchedule(
            [contact.force_task for contact in robot.contacts if contact.force_task is not None]
        )
        self.formulation = make_formulation(
            self.settings.formulation,
            self.settings.optimization,
            make_solver(self.settings.solver),
        )
        self.gate = OutputGate(
            self.model.torque_limit, self.settings.rate_limit(robot), self.settings.control_dt
        )
        self._anchor = RateAnchor(
            self.model.torque_limit, self.gate.torque_step_limit, self.settings.control_dt
        )
        hierarchy = self.settings.hierarchy or robot.hierarchy
        self.priorities = TransitionSchedule(
            matrix_from_hierarchy(robot.task_names, hierarchy), self.sigma_min_of, self.solvability
        )
        self._priorities = self.priorities.in_force  # of the last step
        self._time = 0.0  # [s] of the last state looked at
        self._stay = False  # tasks stay where they were when references began
        self._last: StepResult | None = None
        self._limits: Limits | None = None
        self._contact_rows_seen: ContactRows | None = None  # of the last state looked at
        self._events: list[TransitionEvent] = []
        self.counts = {"qp_failures": 0, "fallback_ticks": 0, "relaxed_ticks": 0, "stale_ticks": 0}
        self.counts["dropped_levels"] = 0
        self.counts |= self.formulation.solver.counts

    @classmethod
    def for_robot(cls, robot: str | Path, settings: Settings | None = None) -> Controller:
        """Controller of a robot by name or by the path of its robot.yaml."""
        return cls(load_robot(robot), settings)

    def warm_up(self) -> None:
        """Compile and load every kernel, so that no tick takes longer for it, also in contact."""
        warm_up(self)

    def reset(self) -> None:
        """Forget the past: transitions, references, accumulated force errors, last torque."""
        self.references.reset()
        self.force_references.reset()
        self.priorities.reset()
        self.force_bounds.reset()
        self.sensing.reset()
        self.contacts.reset()
        self.obstacles.reset()
        for task in self.robot.tasks:
            task.reset()
        self.formulation.solver.reset()
        self._time = 0.0
        self._anchor.reset()
        self._last = None
        self._limits = None
        self._contact_rows_seen = None
        self._events.clear()

    def schedule_of(self, task: str) -> ReferenceSchedule:
        """References among which those of `task` are: a task, or a contact with a force task.

        Raises:
            UnknownName: there is none of that name.
        """
        names = (self.references.names, self.force_references.names)
        if task in names[1]:
            return self.force_references
        if task not in names[0]:
            raise UnknownName("task", task, names[0] + names[1])
        return self.references

    def add_reference(self, reference: ReferenceTrajectory) -> None:
        """Let a task follow `reference` from its start time on; UnknownName if there is none."""
        self.schedule_of(reference.task).add(reference)

    def add_transition(self, transition: Transition, now: float) -> bool:
        """Schedule a change of priorities; False when it is a repeat that changes nothing.

        Raises:
            InvalidValue: the formulation in use would lose its solution on the way, or it cannot
            keep the transition's torque rate.
        """
        if transition.torque_rate > 0.0 and not self.formulation.blends:
            raise InvalidValue(
                f"torque_rate = {transition.torque_rate} Nm/s given with formulation "
                f"'{self.formulation.name}'; only one that blends orders keeps it: "
                + ", ".join(name for name, kind in FORMULATIONS.items() if kind.blends)
            )
        if self.priorities.is_repeat(transition):
            return False
        self.priorities.check_solvable(transition)
        self._events += self.priorities.add(transition, now)
        return True

    def take_events(self) -> tuple[TransitionEvent, ...]:
        """What happened to transitions since the last step; not repeated by the next one."""
        events = tuple(self._events)
        self._events.clear()
        return events

    def observe(self, state: RobotState) -> None:
        """Look at a state without answering it: requests are judged at its configuration."""
        self._time = state.time
        self.model.update(state.q, state.v)
        self._begin_references()
        self.stack.update(self.model, state, self.references)
        planned = self.force_bounds.at(state.time)
        self._contact_rows_seen = self._contact_rows(planned, state.time)

    def start(self, state: RobotState) -> None:
        """Get ready at a state: compile what a step needs, forget the past, and look at it."""
        self.warm_up()
        self.observe(state)

    def set_reference(self, task: str, position: ArrayLike, start: float | None = None) -> None:
        """Let a task go to a standing position from `start` [s] on, at once without.

        Args:
            position: as the task counts it: [m], [rad], or a quaternion x, y, z, w.

        Raises:
            UnknownName: there is no such task.
            WrongSize, InvalidValue: the position does not fit the task.
        """
        kind = self.schedule_of(task).task(task)
        target = kind.static_target(np.array(position, dtype=np.float64))
        begin = self._time if start is None else start
        self.add_reference(ReferenceTrajectory.static(kind, target, begin))

    def change_hierarchy(
        self,
        hierarchy: str,
        start: float | None = None,
        duration: float = 2.0,
        torque_rate: float = 0.0,
    ) -> bool:
        """Schedule a change to a hierarchy such as "a > b = c"; arguments as in Transition.

        Args:
            start: [s], at once without.

        Returns:
            False for a repeat that changes nothing.

        Raises:
            UnknownName, InvalidValue: as `matrix_from_hierarchy` and `add_transition` do.
        """
        target = matrix_from_hierarchy(self.robot.task_names, hierarchy)
        begin = self._time if start is None else start
        transition = Transition(
            target, begin, duration, hierarchy=hierarchy, torque_rate=torque_rate
        )
        return self.add_transition(transition, self._time)

    def step(self, state: RobotState) -> StepResult:
        """Torque for one robot state; never raises for what a robot can be in."""
        begin = perf_counter()
        self._time = state.time
        model = self.model
        dynamics = model.update(state.q, state.v)
        self._begin_references()
        events = tuple(self._events) + tuple(self.priorities.advance(state.time))
        self._events.clear()
        self._priorities = self.priorities.pace(state.time, self.settings.control_dt)
        self.stack.update(model, state, self.references)
        before = self._rate_anchor(dynamics, state)
        self.contacts.begin(state.time)
        limits = self._limits = self._update_limits(dynamics, state, before)
        self._contact_rows_seen = limits.contact_rows
        after_terms = perf_counter()
        self.formulation.solver.begin_step()
        solution = solve_settled(
            self.formulation,
            self._problem_views(),
            self.contacts,
            limits.normal_bounds.active,
            partial(self._contact_rows, limits.normal_bounds, state.time),
        )
        self.formulation.solver.end_step()
        after_solve = perf_counter()
        status = StepStatus.after(solution.status)
        if status is StepStatus.FALLBACK:
            torque = braking_torque(
                dynamics, state.v, model.torque_limit, contact_rows=limits.contact_rows
            )
        else:
            torque = solution.torque
            events += tuple(self.priorities.settle(solution.progress, state.time))
            boxes = limits.boxes
            if status is StepStatus.SOLVED and (boxes.acceleration.slack or boxes.torque.slack):
                status = StepStatus.RELAXED
        gated = self.gate.apply(torque, before, dynamics, state.v)
        self._anchor.sent(gated.torque, state.time)
        self._count(status, solution.levels_dropped)
        self._last = StepResult(
            state.time,
            gated.torque,
            status,
            solution,
            gated.hits,
            events,
            after_terms - begin,
            after_solve - after_terms,
            perf_counter() - begin,
        )
        return self._last

    def report(self) -> Report:
        """Account of the last step; call it before the next one.

        Raises:
            RuntimeError: no step was made yet.
        """
        result, limits = self._last, self._limits
        if result is None or limits is None:
            raise RuntimeError("report() needs a step() before it")
        contacts = contact_report(
            self.contacts, self.force_bounds.planned, limits.normal_bounds, result.solution.force
        )
        loads = load_report(self.contacts, limits.normal_bounds, result.solution.force)
        states = self.obstacles.states(result.time)
        return make_report(
            result,
            limits,
            task_reports(self.stack, self.references, result.time),
            self.priorities.alpha,
            self.priorities.sigma_min,
            contacts,
            loads,
            tuple(ObstacleReport(planned, state) for planned, state in states),
            self.counts | self.gate.counts,
        )

    def problem(self) -> ControlProblem:
        """The control problem of the last step: copies, which the next step leaves alone."""
        return deepcopy(self._problem_views())

    def _problem_views(self) -> ControlProblem:
        limits, model = self._limits, self.model
        assert limits is not None
        boxes = limits.boxes
        return ControlProblem(
            self.stack.jacobian,
            self.stack.target,
            self.stack.starts,
            self._priorities,
            model.dynamics.mass_matrix,
            model.dynamics.bias,
            model.v,
            boxes.acceleration.bounds,
            boxes.torque.bounds,
            boxes.torque.hard,
            limits.obstacle_rows,
            limits.contact_rows,
            model.nv - model.na,
            second_order_terms(self.stack, model)
            if self.settings.optimization.second_order
            else None,
        )

    def hold(self) -> None:
        """Keep the robot where it is at the next state, until `activate`.

        Forgets references and transitions; tasks of the robot's file with a reference of their
        own stay where they are too.
        """
        self._stay = True
        self.references.reset()
        self.force_references.reset()
        self._events += self.priorities.cancel(self._time)

    def activate(self) -> None:
        """Leave `hold`: tasks without a reference follow the robot's file, or stay."""
        if self._stay:
            self._stay = False
            self.references.begin(self.model)

    def brake(self, state: RobotState) -> Array:
        """Torque (a,) [Nm] that brakes the robot within torque and rate limits."""
        self._time = state.time
        dynamics = self.model.update(state.q, state.v)
        before = self._rate_anchor(dynamics, state)
        self.contacts.begin(state.time)
        rows = self._contact_rows(self.force_bounds.at(state.time), state.time)
        torque = braking_torque(dynamics, state.v, self.model.torque_limit, contact_rows=rows)
        gated = self.gate.apply(torque, before, dynamics, state.v)
        self._anchor.sent(gated.torque, state.time)
        return gated.torque

    def _begin_references(self) -> None:
        if not self.references.has_begun:
            self.references.begin(self.model, self._stay)
            self.force_references.begin(self.model)

    def _rate_anchor(self, dynamics: Dynamics, state: RobotState) -> Array:
        """Torque (a,) [Nm] from which the rate limit counts in this step."""
        if self._anchor.is_set and not self._anchor.is_held(state.time):
            return self._anchor.at(state.time)
        holding = braking_torque(dynamics, state.v, self.model.torque_limit)
        if self._anchor.is_set:
            # How a floating base was held is not known here; from what was sent it goes on.
            return self._anchor.at(state.time, None if self.model.floating_base else holding)
        room = np.inf if self.model.floating_base else FIRST_SHARE
        return self._anchor.first(state.torque, holding, room)

    def _update_limits(self, dynamics: Dynamics, state: RobotState, before: Array) -> Limits:
        boxes = self.constraints.update(
            self.model, dynamics, state, before, self.settings.control_dt
        )
        planned = self.force_bounds.at(state.time)
        bounds = self.sensing.confirm(planned, state.time, state.wrenches)
        self.counts["stale_ticks"] += bool(bounds.stale) or self.obstacles.is_stale(state.time)
        return Limits(
            boxes,
            self._contact_rows(bounds, state.time),
            bounds,
            self.obstacles.rows(state.time),
        )

    def _contact_rows(self, bounds: NormalBounds, time: float) -> ContactRows | None:
        return self.contacts.rows(self.model, bounds, self.force_references, time)

    def sigma_min_of(self, alpha: Array) -> float:
        """Smallest singular value of [P_1 .. P_k] at the present configuration."""
        return smallest_singular_value(
            generalized_projectors(
                self.stack.jacobian, self.stack.starts, np.array(alpha), self.formulation.projector
            )
        )

    def solvability(self) -> Solvability:
        """What transitions must keep, in the configuration and contacts last looked at."""
        jacobian, contacts = self.stack.jacobian, self._contact_rows_seen
        if contacts is not None:
            jacobian = kept_by_contacts(jacobian, contacts.jacobian)
        return self.formulation.solvability(jacobian, self.stack.starts)

    def _count(self, status: StepStatus, levels_dropped: int) -> None:
        self.counts |= self.formulation.solver.counts
        self.counts["dropped_levels"] += levels_dropped
        if status is StepStatus.FALLBACK:
            self.counts["qp_failures"] += 1
            self.counts["fallback_ticks"] += 1
        elif status is StepStatus.RELAXED:
            self.counts["relaxed_ticks"] += 1
