"""The controller: robot state in, torque out; no ROS, no clock of its own."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from time import perf_counter

from ghc_controller.constraints import ObstacleDistance
from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.contacts import (
    BoundsInForce,
    ContactSensing,
    ContactSet,
    FrictionCone,
    NormalForce,
)
from ghc_controller.control.answer import Answer
from ghc_controller.control.compiled_step import CompiledStep
from ghc_controller.control.gain_check import (
    check_gains,
    check_obstacle_horizon,
    check_velocity_damping,
)
from ghc_controller.control.judgment import Judgment
from ghc_controller.control.problem_views import ProblemViews
from ghc_controller.control.requests import Requests
from ghc_controller.control.status import StatusReports
from ghc_controller.control.step_in_parts import StepInParts
from ghc_controller.control.torque_output import TorqueOutput
from ghc_controller.control.tuning import Tuning
from ghc_controller.core import Clock
from ghc_controller.errors import UnknownName
from ghc_controller.formulations import make_formulation
from ghc_controller.hierarchy import TransitionEvent, TransitionSchedule, matrix_from_hierarchy
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.migration.old_methods import OldMethods
from ghc_controller.previews.follower import Follower
from ghc_controller.previews.preview import Preview
from ghc_controller.problem.control_problem import ContactRows, ControlProblem
from ghc_controller.qp import make_solver
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.report.report import StepResult, StepStatus
from ghc_controller.report.reporting import Limits
from ghc_controller.robot.library import given_robot, load_robot
from ghc_controller.robot.robot import Robot
from ghc_controller.safety.base_plausibility import check_orientation
from ghc_controller.safety.gate import OutputGate
from ghc_controller.settings import Settings, make_constraints
from ghc_controller.tasks.second_order import check_second_order
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array, RobotState


class Controller(Requests, StatusReports, Judgment, OldMethods):
    """Generalized hierarchical control of one robot.

    Each `step` goes one way: state, tasks and constraints, priority matrix, formulation, output
    gate, torque. References and transitions carry the time at which they apply and may be given
    long before.

    Raises:
        GhcError: from the robot's file or the settings, with what was given and expected.
    """

    def __init__(
        self, robot: Robot, settings: Settings | None = None, clock: Clock | None = None
    ) -> None:
        """Make a controller of a copy of the robot.

        Args:
            settings: None = those of the robot's file.
            clock: where time is real: no further level begins after `step_time_share` of the
                control period of it. None: a step depends on nothing but what it is given.
        """
        # A copy, since another controller may have been made of it.
        self.robot = robot = given_robot(robot).copy()
        self.settings = Settings.for_robot(robot) if settings is None else settings
        self.model = robot.model
        self.references = ReferenceSchedule(robot.tasks)
        dt = self.settings.control_dt
        check_gains(robot.tasks, dt)
        check_velocity_damping(self.settings.optimization.velocity_damping, dt)
        check_obstacle_horizon(self.settings.obstacle_horizon, dt)
        self.stack = TaskStack(robot.tasks, self.model.nv)
        if self.settings.optimization.second_order:
            check_second_order(self.stack, self.model)
        self.contacts = ContactSet(
            robot.contacts, self.model.weight if self.model.floating_base else 0.0
        )
        self.constraints = make_constraints(
            robot, self.settings, (NormalForce(self.contacts), FrictionCone(self.contacts))
        )
        self.force_bounds = BoundsInForce(robot.contacts)
        self.sensing = ContactSensing(robot.contacts, self.force_bounds)
        self.obstacles = self.constraints.one_of(ObstacleDistance)
        rows = self.constraints.constraints
        self._bodies = [one for one in rows if isinstance(one, BodyDistance)]
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
        solver = self.formulation.solver
        solver.clock = clock
        solver.step_time = self.settings.solving.step_time_share * self.settings.control_dt
        self.gate = OutputGate(
            self.model.torque_limit, self.settings.rate_limit(robot), self.settings.control_dt
        )
        self.output = TorqueOutput(
            self.model, self.constraints, self.gate, self.settings.control_dt
        )
        hierarchy = self.settings.hierarchy or robot.hierarchy
        self.priorities = TransitionSchedule(
            matrix_from_hierarchy(robot.task_names, hierarchy), self.sigma_min_of, self.solvability
        )
        self.tuning = Tuning(self)
        self.views = ProblemViews(self.model, self.stack)
        self.stays = False  # tasks stay where they were when references began
        self._time = 0.0  # [s] of the last state looked at
        self._last: StepResult | None = None
        self._limits: Limits | None = None
        self._priorities: Priorities | None = None  # of the last step; None: those in force
        self._contact_rows_seen: ContactRows | None = None  # of the last state looked at
        self._compiled, self._parts = CompiledStep(self), StepInParts(self)
        self._events: list[TransitionEvent] = []
        names = ("qp_failures", "fallback_ticks", "relaxed_ticks", "stale_ticks", "dropped_levels")
        self.counts = dict.fromkeys(names, 0) | self.formulation.solver.counts

    @classmethod
    def for_robot(
        cls, robot: str | Path, settings: Settings | None = None, clock: Clock | None = None
    ) -> Controller:
        """Controller of a robot by name or by the path of its robot.yaml."""
        return cls(load_robot(robot), settings, clock)

    def reset(self) -> None:
        """Forget the past: transitions, references, accumulated force errors, last torque.

        Changed gains, weights, limits and formulation stay, at the end of their blend.
        """
        self.tuning.finish()
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
        self.output.reset()
        self._compiled.reset()
        self._last = self._limits = self._priorities = self._contact_rows_seen = None
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
        left_out = self._followers[preview.kind].follow(preview, now)
        if preview.kind == self.obstacles.kind:
            for bodies in self._bodies:
                bodies.follow_obstacles(preview)
        return left_out

    def observe(self, state: RobotState) -> None:
        """Look at a state without answering it: requests are judged at its configuration.

        Raises:
            WrongSize: q or v has another shape.
            InvalidValue: the quaternion of a floating base is not of unit length.
        """
        self._time = state.time
        self.model.update(state.q, state.v)
        if self.model.floating_base:
            check_orientation(state.q[3:7])
        self._parts.begin_references()
        self.stack.update(self.model, state, self.references.targets(state.time))
        planned = self.force_bounds.at(state.time)
        bounds = self.sensing.preview(planned, state.time, state.wrenches)
        self._contact_rows_seen = self._parts.contact_rows(bounds, state.time)

    def start(self, state: RobotState) -> None:
        """Get ready at a state: forget the past, and look at it; raises as `observe`."""
        self.reset()
        self.observe(state)

    def step(self, state: RobotState) -> StepResult:
        """Torque for one robot state; never raises for what a robot can be in."""
        time = self._time = state.time
        found = None if self._events else self._compiled.again(state)
        if type(found) is StepResult:
            self._last = found
            return found
        begin = perf_counter()
        if found is None:
            self.formulation.solver.start_clock()
            self.tuning.advance(time)
        if found is not None or self._compiled.takes(state):
            compiled, answer = True, self._compiled.answer(state, found)
        else:
            compiled, answer = False, self._parts.answer(state)
        events, _, limits, priorities, solution, torque, time_terms, time_solve = answer
        self._limits, self._priorities = limits, priorities
        self._contact_rows_seen = limits.contact_rows
        happened = (*self._events, *events)
        self._events.clear()
        status = StepStatus.after(solution.status)
        hits: tuple[str, ...] = ()
        passed = torque is not None
        if torque is None:
            torque, hits = self._gated(state, answer, status)
        if status is not StepStatus.FALLBACK:
            if not compiled:
                happened += tuple(self.priorities.settle(solution.progress, time))
            boxes = limits.boxes
            if status is StepStatus.SOLVED and (boxes.acceleration.slack or boxes.torque.slack):
                status = StepStatus.RELAXED
        if limits.normal_bounds.stale or self.constraints.is_stale(time):
            self.counts["stale_ticks"] += 1
        if not passed or status is not StepStatus.SOLVED:
            self._count(status, solution.levels_dropped)
        self._last = StepResult(
            time,
            torque,
            status,
            solution,
            hits,
            happened,
            time_terms,
            time_solve,
            perf_counter() - begin + (0.0 if found is None else time_terms + time_solve),
        )
        return self._last

    def _gated(
        self, state: RobotState, answer: Answer, status: StepStatus
    ) -> tuple[Array, tuple[str, ...]]:
        """Torque (a,) [Nm] of an answer, or of the brakes, through the gate; what that changed."""
        contacts = answer.limits.contact_rows
        if status is StepStatus.FALLBACK:
            torque = self.output.braking(state, contacts)
        else:
            torque = answer.solution.torque
        gated = self.output.gated(torque, answer.before, state, contacts)
        return gated.torque, gated.hits

    def problem(self) -> ControlProblem:
        """The control problem of the last step: copies, which the next step leaves alone.

        Raises:
            RuntimeError: no step was made yet.
        """
        if self._limits is None:
            raise RuntimeError("problem() needs a step() before it")
        priorities = self._priorities or self.priorities.in_force
        second_order = self.settings.optimization.second_order
        return deepcopy(self.views.of(priorities, self._limits, second_order))

    def brake(self, state: RobotState) -> Array:
        """Torque (a,) [Nm] that brakes the robot within torque and rate limits."""
        self._time = state.time
        self.model.update(state.q, state.v)
        before = self.output.before(state)
        self.contacts.begin(state.time)
        rows = self._parts.contact_rows(self._parts.force_bounds(state), state.time)
        return self.output.gated(self.output.braking(state, rows), before, state, rows).torque
