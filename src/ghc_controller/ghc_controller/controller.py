"""The controller: robot state in, torque out; no ROS, no clock of its own."""

from __future__ import annotations

from copy import deepcopy
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np

from ghc_controller.constraints import ObstacleDistance
from ghc_controller.contacts import (
    BoundsInForce,
    ContactSensing,
    ContactSet,
    FrictionCone,
    NormalBounds,
    NormalForce,
    solve_settled,
)
from ghc_controller.control.requests import Requests
from ghc_controller.control.status import StatusReports
from ghc_controller.errors import UnknownName
from ghc_controller.formulations import make_formulation
from ghc_controller.hierarchy import (
    Solvability,
    TransitionEvent,
    TransitionSchedule,
    generalized_projectors,
    matrix_from_hierarchy,
    smallest_singular_value,
)
from ghc_controller.previews.follower import Follower
from ghc_controller.previews.preview import TORQUE_LIMITS, Preview
from ghc_controller.problem.control_problem import ContactRows, ControlProblem
from ghc_controller.problem.reduction import kept_by_contacts
from ghc_controller.qp import make_solver
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.report.report import StepResult, StepStatus
from ghc_controller.report.reporting import Limits
from ghc_controller.robot.library import load_robot
from ghc_controller.robot.robot import Robot
from ghc_controller.safety.braking import braking_torque
from ghc_controller.safety.gate import Output, OutputGate
from ghc_controller.safety.rate_anchor import RateAnchor
from ghc_controller.settings import Settings, make_constraints
from ghc_controller.tasks.second_order import second_order_terms
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array, Dynamics, RobotState
from ghc_controller.warm_up import warm_up


class Controller(Requests, StatusReports):
    """Generalized hierarchical control of one robot.

    Each `step` goes one way: state, tasks and constraints, priority matrix, formulation, output
    gate, torque. References and transitions carry the time at which they apply and may be given
    long before.

    Raises:
        GhcError: from the robot's file or the settings, with what was given and expected.
    """

    def __init__(self, robot: Robot, settings: Settings | None = None) -> None:
        self.robot = robot
        self.settings = Settings.for_robot(robot) if settings is None else settings
        self.model = robot.model
        self.references = ReferenceSchedule(robot.tasks)
        self.stack = TaskStack(robot.tasks, self.model.nv)
        self.contacts = ContactSet(
            robot.contacts, self.model.weight if self.model.floating_base else 0.0
        )
        self.constraints = make_constraints(
            robot, self.settings, (NormalForce(self.contacts), FrictionCone(self.contacts))
        )
        self.force_bounds = BoundsInForce(robot.contacts)
        self.sensing = ContactSensing(robot.contacts, self.force_bounds)
        self.obstacles = self.constraints.one_of(ObstacleDistance)
        followers: list[Follower] = [self.force_bounds, *self.constraints.following]
        self._followers = {one.kind: one for one in followers}
        self.force_references = ReferenceSchedule(
            [contact.force_task for contact in robot.contacts if contact.force_task is not None]
        )
        self.formulation = make_formulation(
            self.settings.formulation,
            self.settings.optimization,
            make_solver(self.settings.qp_solver, self.settings.solving),
            self.settings.own,
        )
        self.gate = OutputGate(
            self.model.torque_limit, self.settings.rate_limit(robot), self.settings.control_dt
        )
        self._anchor = RateAnchor(
            self.model.torque_limit,
            self.gate.torque_step_limit,
            self.settings.control_dt,
            self.model.floating_base,
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
        names = ("qp_failures", "fallback_ticks", "relaxed_ticks", "stale_ticks", "dropped_levels")
        self.counts = dict.fromkeys(names, 0) | self.formulation.solver.counts

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
        self.constraints.reset()
        self.stack.reset()
        self.formulation.reset()
        self._time = 0.0
        self._anchor.reset()
        self._last = None
        self._limits = None
        self._contact_rows_seen = None
        self._events.clear()

    @property
    def preview_kinds(self) -> tuple[str, ...]:
        """Kinds of previews that a constraint of this controller follows."""
        return tuple(self._followers)

    def follow(self, preview: Preview, now: float | None = None) -> tuple[UnknownName, ...]:
        """Let the constraint of that kind follow a preview.

        Args:
            preview: what a generator planned.
            now: [s] from when on it is followed; None = from its start.

        Returns:
            What is wrong with each row that was left out; empty when none was.

        Raises:
            UnknownName: no constraint follows this kind.
            InvalidValue: bounds that robot.yaml does not allow; the preview before stays.
        """
        if preview.kind not in self._followers:
            raise UnknownName("kind of preview", preview.kind, self._followers)
        return self._followers[preview.kind].follow(preview, now)

    def observe(self, state: RobotState) -> None:
        """Look at a state without answering it: requests are judged at its configuration."""
        self._time = state.time
        self.model.update(state.q, state.v)
        self._begin_references()
        self.stack.update(self.model, state, self.references.targets(state.time))
        planned = self.force_bounds.at(state.time)
        self._contact_rows_seen = self._contact_rows(planned, state.time)

    def start(self, state: RobotState) -> None:
        """Get ready at a state: compile what a step needs, forget the past, and look at it."""
        self.warm_up()
        self.observe(state)

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
        self.stack.update(model, state, self.references.targets(state.time))
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
            lambda: self.constraints.on_forces(
                self._contact_rows(limits.normal_bounds, state.time)
            ),
        )
        self.formulation.solver.end_step()
        after_solve = perf_counter()
        status = StepStatus.after(solution.status)
        if status is StepStatus.FALLBACK:
            torque = braking_torque(
                dynamics,
                state.v,
                self._braking_limit(state.time),
                contact_rows=limits.contact_rows,
            )
        else:
            torque = solution.torque
            events += tuple(self.priorities.settle(solution.progress, state.time))
            boxes = limits.boxes
            if status is StepStatus.SOLVED and (boxes.acceleration.slack or boxes.torque.slack):
                status = StepStatus.RELAXED
        gated = self._gated(torque, before, dynamics, state)
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
            limits.rows,
            limits.contact_rows,
            model.nv - model.na,
            second_order_terms(self.stack, model)
            if self.settings.optimization.second_order
            else None,
        )

    def brake(self, state: RobotState) -> Array:
        """Torque (a,) [Nm] that brakes the robot within torque and rate limits."""
        self._time = state.time
        dynamics = self.model.update(state.q, state.v)
        before = self._rate_anchor(dynamics, state)
        self.contacts.begin(state.time)
        rows = self._contact_rows(self.force_bounds.at(state.time), state.time)
        limit = self._braking_limit(state.time)
        torque = braking_torque(dynamics, state.v, limit, contact_rows=rows)
        return self._gated(torque, before, dynamics, state).torque

    def _braking_limit(self, time: float) -> Array:
        """Torque (a,) [Nm] that braking may use: of the robot, or of a preview where tighter."""
        limit = self.model.torque_limit
        for limits in self.constraints.limits:
            if limits.kind == TORQUE_LIMITS and limits.planned:
                now = limits.at(time)
                limit = np.minimum(limit, np.minimum(now.upper, -now.lower))
        return limit

    def _begin_references(self) -> None:
        if not self.references.has_begun:
            self.references.begin(self.model, self._stay)
            self.force_references.begin(self.model)

    def _rate_anchor(self, dynamics: Dynamics, state: RobotState) -> Array:
        """Torque (a,) [Nm] from which the rate limit counts in this step."""
        return self._anchor.before(
            state, partial(braking_torque, dynamics, state.v, self.model.torque_limit)
        )

    def _gated(
        self, torque: Array, before: Array, dynamics: Dynamics, state: RobotState
    ) -> Output:
        """What leaves in answer to a state, noted as the anchor of the next one."""
        output = self.gate.apply(torque, before, dynamics, state.v)
        self._anchor.sent(output.torque, state.time)
        return output

    def _update_limits(self, dynamics: Dynamics, state: RobotState, before: Array) -> Limits:
        planned = self.force_bounds.at(state.time)
        bounds = self.sensing.confirm(planned, state.time, state.wrenches)
        self.counts["stale_ticks"] += bool(bounds.stale) or self.constraints.is_stale(state.time)
        contacts = self._contact_rows(bounds, state.time)
        boxes = self.constraints.update(
            self.model,
            dynamics,
            state,
            before,
            self.settings.control_dt,
            contacts,
        )
        contacts = self.constraints.on_forces(contacts)
        return Limits(boxes, contacts, bounds, self.constraints.rows)

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
