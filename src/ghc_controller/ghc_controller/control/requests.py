"""Requests to a controller: references, transitions, and hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.control.tuning import Tuning
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.formulations import Formulation, blending_formulations
from ghc_controller.hierarchy import (
    Transition,
    TransitionEvent,
    TransitionSchedule,
    matrix_from_hierarchy,
)
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.robot.robot import Robot


class Requests:
    """The part of `Controller` that takes requests; they may be given long before they apply."""

    robot: Robot
    model: RobotModel
    formulation: Formulation
    references: ReferenceSchedule
    force_references: ReferenceSchedule
    priorities: TransitionSchedule
    tuning: Tuning
    _time: float  # [s] of the last state looked at
    stays: bool  # tasks stay where they were when references began
    _events: list[TransitionEvent]

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
            if "formulation" in self.tuning.moves:
                raise InvalidValue(
                    f"torque_rate = {transition.torque_rate} Nm/s given while a change of "
                    "formulation is under way, which keeps none; repeat this one after it"
                )
            raise InvalidValue(
                f"torque_rate = {transition.torque_rate} Nm/s given with formulation "
                f"'{self.formulation.name}'; only one that blends orders keeps it: "
                + ", ".join(blending_formulations())
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

    def set_reference(
        self,
        task: str,
        position: ArrayLike,
        start: float | None = None,
        wrench: ArrayLike | None = None,
    ) -> None:
        """Let a task go to a standing position from `start` [s] on, at once without.

        Args:
            position: as the task counts it: [m], [rad], or a quaternion x, y, z, w.
            wrench: (m,) [N] to be exerted on the environment by rows under force control.

        Raises:
            UnknownName: there is no such task.
            WrongSize, InvalidValue: the position or wrench does not fit the task.
        """
        kind = self.schedule_of(task).task(task)
        target = kind.static_target(np.array(position, dtype=np.float64))
        if wrench is not None:
            target = target._replace(wrench=np.array(wrench, dtype=np.float64))
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

    def tune(self, values: Mapping[str, Any], duration: float | None = None) -> None:
        """Change gains, weights, limits or the formulation by a blend from the next step on.

        Args:
            values: by the names of parameters, such as `tasks.hand.stiffness`: `Tuning.names`.
            duration: [s] of the blend; None = `tuning_duration` of the settings.

        Raises:
            UnknownName, ConfigurationError: a name or value that is not known.
            InvalidValue: what cannot change while the controller runs, with the reason.
        """
        self.tuning.begin(self.tuning.check(values), duration)

    def hold(self) -> None:
        """Keep the robot where it is at the next state, until `activate`.

        Forgets references and transitions; tasks of the robot's file with a reference of their
        own stay where they are too.
        """
        self.stays = True
        self.references.reset()
        self.force_references.reset()
        self._events += self.priorities.cancel(self._time)

    def activate(self) -> None:
        """Leave `hold`: tasks without a reference follow the robot's file, or stay."""
        if self.stays:
            self.stays = False
            if self.references.has_begun:  # else with the next state
                self.references.begin(self.model)
