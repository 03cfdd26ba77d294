"""The controller: robot state in, torque out; no ROS, no clock of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np

from ghc_controller.braking import braking_torque
from ghc_controller.constraints import Boxes, Slack
from ghc_controller.controller_settings import ControllerSettings, make_constraints
from ghc_controller.formulations import (
    ControlProblem,
    Solution,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.hierarchy import (
    Transition,
    TransitionEvent,
    TransitionSchedule,
    generalized_projectors,
    matrix_from_hierarchy,
    smallest_singular_value,
)
from ghc_controller.output_gate import OutputGate
from ghc_controller.qp import make_solver
from ghc_controller.reference import ReferenceTrajectory
from ghc_controller.reference_schedule import ReferenceSchedule
from ghc_controller.report import Report, StepResult, StepStatus, TaskReport
from ghc_controller.robot_config import RobotConfig, load_robot_config
from ghc_controller.robot_model import RobotModel
from ghc_controller.robots import find_robot
from ghc_controller.task_stack import TaskStack
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, Bounds, RobotState

_STATUS = {
    SolutionStatus.SOLVED: StepStatus.SOLVED,
    SolutionStatus.RELAXED: StepStatus.RELAXED,
    SolutionStatus.FAILED: StepStatus.FALLBACK,
}


class Controller:
    """Generalized hierarchical control of one robot.

    Each `step` goes one way: state, tasks and constraints, priority matrix, formulation, output
    gate, torque. References and transitions carry the time at which they apply and may be given
    long before.

    Raises:
        GhcError: from the robot's file or the settings, with what was given and expected.
    """

    def __init__(self, robot: RobotConfig, settings: ControllerSettings | None = None) -> None:
        self.robot = robot
        self.settings = settings or ControllerSettings()
        self.model = robot.model
        self.references = ReferenceSchedule(robot.tasks)
        self.stack = TaskStack(robot.tasks, self.model.nv)
        self.constraints = make_constraints(robot, self.settings)
        self.formulation = make_formulation(
            self.settings.formulation,
            self.settings.optimization,
            make_solver(self.settings.solver),
        )
        self.gate = OutputGate(
            self.model.torque_limit, self.settings.rate_limit(robot), self.settings.control_dt
        )
        hierarchy = self.settings.hierarchy or robot.hierarchy
        self.priorities = TransitionSchedule(
            matrix_from_hierarchy(robot.task_names, hierarchy), self._smallest_singular_value
        )
        self._alpha = np.array(self.priorities.alpha)  # writable: one compiled signature
        self._applied: Array | None = None
        self._last: StepResult | None = None
        self._boxes: Boxes | None = None
        self._events: list[TransitionEvent] = []
        self.counts = {"qp_failures": 0, "fallback_ticks": 0, "relaxed_ticks": 0}

    @classmethod
    def for_robot(
        cls, robot: str | Path, settings: ControllerSettings | None = None
    ) -> Controller:
        """Controller of a robot by name or by the path of its robot.yaml."""
        return cls(load_robot_config(find_robot(robot)), settings)

    def warm_up(self) -> None:
        """Compile and load every kernel, so that no tick takes longer for it, also in contact."""
        wrenches = {
            task.force.contact: np.full(6, 10.0 + 10.0 * task.force.threshold)
            for task in self.robot.tasks
            if task.force is not None
        }
        self.model.update(self.model.q, self.model.v)
        for task in self.robot.tasks:
            self.references.add(_moving_reference(task, self.model))
        for time in (0.0, 0.5):
            q = self.model.q + 0.1 * time
            v, torque = np.zeros(self.model.nv), np.zeros(self.model.na)
            self.step(RobotState(time, q, v, torque, wrenches))
        problem = self._problem()
        unactuated = problem.unactuated
        tight = Bounds(problem.bias[unactuated:] - 1e-3, problem.bias[unactuated:] + 1e-3)
        self.formulation.solve(replace(problem, torque=tight))
        self._smallest_singular_value(self._alpha)
        self.reset()

    def reset(self) -> None:
        """Forget the past: transitions, references, accumulated force errors, last torque."""
        self.references.reset()
        self.priorities.reset()
        for task in self.robot.tasks:
            task.reset()
        self._applied = None
        self._last = None
        self._events.clear()

    def add_reference(self, reference: ReferenceTrajectory) -> None:
        """Let a task follow `reference` from its start time on; UnknownName if there is none."""
        self.references.add(reference)

    def add_transition(self, transition: Transition, now: float) -> bool:
        """Schedule a change of priorities; False when it is a repeat that changes nothing.

        Raises:
            InvalidValue: eq. 13b would lose its solution on the way.
        """
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
        self.model.update(state.q, state.v)
        if not self.references.has_begun:
            self.references.begin(self.model)
        self.stack.update(self.model, state, self.references)

    def step(self, state: RobotState) -> StepResult:
        """Torque for one robot state; never raises for what a robot can be in."""
        begin = perf_counter()
        model, settings = self.model, self.settings
        dynamics = model.update(state.q, state.v)
        if not self.references.has_begun:
            self.references.begin(model)
        events = tuple(self._events) + tuple(self.priorities.advance(state.time))
        self._events.clear()
        self._alpha[:] = self.priorities.alpha
        self.stack.update(model, state, self.references)
        applied = self._applied if state.torque is None else state.torque
        self._boxes = self.constraints.update(model, dynamics, state, applied, settings.control_dt)
        after_terms = perf_counter()
        solution = self.formulation.solve(self._problem())
        after_solve = perf_counter()
        status = _STATUS[solution.status]
        if status is StepStatus.FALLBACK:
            torque = braking_torque(dynamics, state.v, model.torque_limit)
        else:
            torque = solution.torque
            if status is StepStatus.SOLVED and (
                self._boxes.acceleration.slack or self._boxes.torque.slack
            ):
                status = StepStatus.RELAXED
        gated = self.gate.apply(torque, applied, dynamics, state.v)
        self._applied = gated.torque
        self._count(status)
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
        result, boxes = self._last, self._boxes
        if result is None or boxes is None:
            raise RuntimeError("report() needs a step() before it")
        solution = result.solution
        active: tuple[str, ...] = ()
        slack = boxes.acceleration.slack + boxes.torque.slack
        reason = ""
        if result.status is StepStatus.FALLBACK:
            reason = "no torque meets the hard rows: " + ", ".join(_conflicting(boxes))
        else:
            active = boxes.acceleration.active(solution.acceleration)
            active += boxes.torque.active(solution.torque)
            slack += self._solution_slack(solution, boxes)
        return Report(
            result,
            tuple(self._task_report(i, result.time) for i in range(len(self.stack.tasks))),
            self._alpha.copy(),
            self.priorities.sigma_min,
            active,
            slack,
            reason,
            self.counts | self.gate.counts,
        )

    def _problem(self) -> ControlProblem:
        assert self._boxes is not None
        model = self.model
        return ControlProblem(
            self.stack.jacobian,
            self.stack.target,
            self.stack.starts,
            self._alpha,
            model.dynamics.mass_matrix,
            model.dynamics.bias,
            self._boxes.acceleration.bounds,
            self._boxes.torque.bounds,
            self._boxes.torque.hard,
            unactuated=model.nv - model.na,
        )

    def _smallest_singular_value(self, alpha: Array) -> float:
        projector = self.settings.optimization.projector
        return smallest_singular_value(
            generalized_projectors(
                self.stack.jacobian, self.stack.starts, np.array(alpha), projector
            )
        )

    def _count(self, status: StepStatus) -> None:
        if status is StepStatus.FALLBACK:
            self.counts["qp_failures"] += 1
            self.counts["fallback_ticks"] += 1
        elif status is StepStatus.RELAXED:
            self.counts["relaxed_ticks"] += 1

    def _task_report(self, index: int, time: float) -> TaskReport:
        error = self.stack.error_of(index).copy()
        task = self.stack.tasks[index]
        force = task.force_row_mask if self.stack.force_rows[index] else np.zeros(task.size, bool)
        return TaskReport(
            task.name,
            error,
            float(np.linalg.norm(error[~force])),
            float(np.linalg.norm(error[force])),
            self.references.target(index, time),
        )

    @staticmethod
    def _solution_slack(solution: Solution, boxes: Boxes) -> tuple[Slack, ...]:
        if solution.acceleration_slack is None:
            return ()
        box = boxes.acceleration
        return tuple(
            Slack(
                box.lower_name(entry)
                if solution.acceleration[entry] < box.bounds.lower[entry]
                else box.upper_name(entry),
                float(solution.acceleration_slack[entry]),
            )
            for entry in np.flatnonzero(solution.acceleration_slack > 0.0)
        )


def _moving_reference(task: Task, model: RobotModel) -> ReferenceTrajectory:
    """A reference of one second that uses every kind of interpolation of a task."""
    position = np.stack([task.current(model)] * 2)
    zeros = np.zeros((2, task.size))
    wrench = None if task.force is None else zeros + 1.0
    return ReferenceTrajectory.for_task(task, np.array([0.0, 1.0]), position, zeros, zeros, wrench)


def _conflicting(boxes: Boxes) -> list[str]:
    """Names of the rows that bound the torque from both sides: the suspects of a conflict."""
    names = [boxes.torque.lower_name(i) for i in range(len(boxes.torque.entries))]
    names += [boxes.torque.upper_name(i) for i in range(len(boxes.torque.entries))]
    return sorted({name for name in names if name})
