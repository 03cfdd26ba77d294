"""The control problem on the arrays of model, tasks and boxes: the same one while they are."""

from __future__ import annotations

from operator import is_not

from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.report.reporting import Limits
from ghc_controller.tasks.second_order import second_order_terms
from ghc_controller.tasks.stack import TaskStack


class ProblemViews:
    """Makes the problem of a step, anew only where a part of it is another object."""

    def __init__(self, model: RobotModel, stack: TaskStack) -> None:
        self._model, self._stack = model, stack
        self._problem: ControlProblem | None = None
        self._parts: tuple[object, ...] = ()  # that it is made of

    def of(self, priorities: Priorities, limits: Limits, second_order: bool) -> ControlProblem:
        """The problem at the last update of model, tasks and limits.

        Args:
            second_order: whether the curvature of the tasks is a part of it.
        """
        model, boxes = self._model, limits.boxes
        curvature = second_order_terms(self._stack, model) if second_order else None
        parts = (
            priorities,
            model.dynamics,
            boxes,
            limits.rows,
            limits.contact_rows,
            curvature,
        )
        if self._problem is None or any(map(is_not, parts, self._parts)):
            self._parts = parts
            self._problem = ControlProblem(
                self._stack.jacobian,
                self._stack.target,
                self._stack.starts,
                priorities,
                model.dynamics.mass_matrix,
                model.dynamics.bias,
                model.v,
                boxes.acceleration.bounds,
                boxes.torque.bounds,
                boxes.torque.hard,
                limits.rows,
                limits.contact_rows,
                model.nv - model.na,
                curvature,
            )
        return self._problem
