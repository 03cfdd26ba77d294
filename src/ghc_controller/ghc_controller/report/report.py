"""What a control step did, as values: the answer, and a report of it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from ghc_controller.constraints import Slack
from ghc_controller.hierarchy import TransitionEvent
from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.types import Array, TaskTarget


class StepStatus(Enum):
    """How the torque came about; the numbers of ghc_msgs/ControllerState."""

    SOLVED = 0
    RELAXED = 1
    FALLBACK = 2

    @classmethod
    def after(cls, status: SolutionStatus) -> StepStatus:
        """That of a step whose QP ended so."""
        if status is SolutionStatus.SOLVED:  # first: the hash of an Enum is Python's
            return cls.SOLVED
        return _STEP_STATUS[status]


_STEP_STATUS = {
    SolutionStatus.SOLVED: StepStatus.SOLVED,
    SolutionStatus.RELAXED: StepStatus.RELAXED,
    SolutionStatus.FAILED: StepStatus.FALLBACK,
}


class StepResult(NamedTuple):
    """Answer to one robot state."""

    time: float  # [s] of the state
    torque: Array  # (a,) [Nm]
    status: StepStatus
    solution: Solution
    gate_hits: tuple[str, ...]
    events: tuple[TransitionEvent, ...]  # what happened to transitions since the last step
    time_terms: float  # [s] model terms, task rows and bounds
    time_solve: float  # [s] projectors, targets and QP
    time_step: float  # [s] whole step


@dataclass(frozen=True, slots=True)
class TaskReport:
    """One task as the controller sees it."""

    name: str
    error: Array  # (m,)
    motion_error: float  # norm of the motion rows
    force_error: float  # [N] norm of the rows under force control
    target: TaskTarget


@dataclass(frozen=True, slots=True)
class ContactReport:
    """Normal forces [N] of the contacts that a generator bounds, and the current bounds."""

    names: tuple[str, ...]  # c
    lower: Array  # (c,)
    upper: Array  # (c,)
    force: Array  # (c,) QP forces; 0 for inactive contacts


@dataclass(frozen=True, slots=True)
class LoadReport:
    """QP forces of the active contacts."""

    names: tuple[str, ...]  # a
    normal: Array  # (a,) [N] normal force of all points together
    friction_use: Array  # (a,) [-] largest |F_t| / (mu F_n) of a point


@dataclass(frozen=True, slots=True)
class ObstacleReport:
    """One virtual obstacle as this step used it."""

    planned: PlannedMotion
    state: Array  # (3, 3) position [m], velocity [m/s], acceleration [m/s^2]; world axes


@dataclass(frozen=True, slots=True)
class LimitReport:
    """Limits of one joint that follow a preview, as this step used them."""

    kind: str  # of the preview
    joint: str
    lower: float  # [rad] or [Nm]
    upper: float


@dataclass(frozen=True, slots=True)
class Report:
    """Report of the last step, made on demand: names and copies that outlive the tick."""

    result: StepResult
    tasks: tuple[TaskReport, ...]
    alpha: Array  # (k, k)
    sigma_min: float  # [-] of [P_1 .. P_k] at the target matrix
    active_constraints: tuple[str, ...]
    slack: tuple[Slack, ...]
    fallback_reason: str
    counts: dict[str, int]
    contacts: ContactReport
    loads: LoadReport
    obstacles: tuple[ObstacleReport, ...]
    limits: tuple[LimitReport, ...] = ()

    @property
    def errors(self) -> dict[str, float]:
        """Norm of the motion rows of each task, by its name."""
        return {task.name: task.motion_error for task in self.tasks}
