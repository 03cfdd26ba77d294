"""What a task is: an error, a Jacobian and a local controller (section 3 of ghc_2015)."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import Follower
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.force_control import ForceControl
from ghc_controller.tasks.kernels import task_rows
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskFields:
    """What robot.yaml says of a task of any kind; each kind adds its own."""

    name: str = declared("name of the task: its row and column of alpha")
    stiffness: tuple[float, ...] = declared(
        "one number, or one per row", unit="1/s^2", domain=NOT_NEGATIVE, per_row=True
    )
    damping: tuple[float, ...] = declared(
        "one number, or one per row", unit="1/s", domain=NOT_NEGATIVE, per_row=True
    )


class Task(Follower):
    """Turns a target into rows `jacobian @ dv -> target` of the least-squares problem.

    With task variable xi, reference xi* and error e, the local controller is (section 6)
        xi''_d = xi''* + stiffness e + damping e',
    and with xi'' = J dv + J' v (eq. 2) the rows are J dv -> xi''_d - J' v.

    A new kind of task is one new file in this folder: a subclass of Task that implements
    `write_rows`, `current` and `from_config`, under the decorator `@register_task("kind")` of
    `registry.py`. Every module of this folder is imported when the first kind is looked up, so
    nothing else needs to change. Another package brings kinds by entry points
    (docs/plugins.md).

    Attributes:
        name, labels, space: see Follower; one label per row.
        stiffness, damping: gains per row, (m,) [1/s^2] and [1/s].
        error_unit: unit of TaskRows.error on motion rows.
        entry: declared fields of an entry in robot.yaml, for its reader and for editors.
        force: turns rows of a task in contact into force rows; None without force control.
    """

    entry: ClassVar[type[TaskFields]] = TaskFields
    error_unit: str = "m"
    force: ForceControl | None = None

    def __init__(
        self,
        name: str,
        labels: Sequence[str],
        stiffness: float | Array,
        damping: float | Array,
        reference: Array | None = None,
    ) -> None:
        """Store gains (one number or one per row) and an optional standing reference.

        Raises:
            InvalidValue: a gain or reference is not finite, or a gain is negative.
            WrongSize: as many gains or reference entries as rows are expected.
        """
        super().__init__(name, labels, reference)
        self.stiffness = self._gain("stiffness", stiffness)
        self.damping = self._gain("damping", damping)

    @property
    def force_row_mask(self) -> NDArray[np.bool_]:
        """(m,) rows that follow a force while TaskRows.force_rows > 0."""
        if self.force is None:
            return np.zeros(self.size, dtype=np.bool_)
        return self.force.force_rows

    def rows(
        self, model: RobotModel, state: RobotState, target: TaskTarget, out: TaskRows | None = None
    ) -> TaskRows:
        """Linearise the task at the state of the last `model.update`.

        Args:
            model: updated with `state`.
            state: the same state; its wrenches and time matter to force rows only.
            target: reference at this instant, with sizes as `check_target` wants them.
            out: rows whose arrays are overwritten, as made by `empty_rows` (row blocks of
                larger C-contiguous arrays do as well); fresh arrays without it.

        Returns:
            `out` or fresh rows; a new TaskRows on the same arrays when force_rows differs.
        """
        if out is None:
            out = self.empty_rows(model.nv)
        self.write_rows(model, target, out)
        force_rows = 0
        if self.force is not None:
            force_rows = self.force.apply(model, state, target, out)
        if force_rows != out.force_rows:
            return TaskRows(out.jacobian, out.target, out.error, force_rows)
        return out

    @classmethod
    @abstractmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Task:
        """Build from one entry of `tasks` in robot.yaml (`kind` is already read)."""

    @abstractmethod
    def write_rows(self, model: RobotModel, target: TaskTarget, out: TaskRows) -> None:
        """Fill the arrays of `out` with motion rows."""

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """Second-order term sum_r weights_r grad^2 xi_r at the last `model.update`, (n, n).

        Symmetric; derivatives are those along `model.integrate`. The rows are motion rows.

        Args:
            weights: (m,) one per row.

        Raises:
            InvalidValue: this kind of task offers none.
        """
        del model, weights
        raise InvalidValue(f"task '{self.name}' offers no second-order term")

    def error_curvature(self, model: RobotModel, error: Array) -> Array:
        """S (n, n) with grad^2 (1/2 |e|^2) = J^T J + S; `error` (m,) as in TaskRows."""
        return -self.curvature(model, error)

    def reset(self) -> None:
        """Forget what was accumulated over time: force control starts afresh."""
        if self.force is not None:
            self.force.reset()

    def empty_rows(self, n: int) -> TaskRows:
        """Zero rows of this task for n velocity coordinates, to be passed as `out`."""
        return TaskRows(np.zeros((self.size, n)), np.zeros(self.size), np.zeros(self.size))

    def fill(
        self,
        out: TaskRows,
        jacobian: Array,
        drift: Array,
        error: Array,
        velocity_error: Array,
        acceleration: Array,
    ) -> None:
        """Write eq. 2 with the local controller into `out`: the short way for a new task.

        Args:
            jacobian: (m, n); drift, error, velocity_error, acceleration (of the reference): (m,).
        """
        task_rows(
            jacobian,
            drift,
            error,
            velocity_error,
            acceleration,
            self.stiffness,
            self.damping,
            out.jacobian,
            out.target,
            out.error,
        )

    def __repr__(self) -> str:
        """Kind, name and rows."""
        return f"{type(self).__name__}({self.name!r}, rows={list(self.labels)})"

    def _gain(self, field: str, value: float | Array) -> Array:
        gain = np.array(value, dtype=np.float64)
        if gain.ndim == 0:
            gain = np.full(self.size, float(gain))
        if gain.shape != (self.size,):
            raise WrongSize(f"task '{self.name}', {field}", gain.shape, (self.size,))
        if not (np.isfinite(gain).all() and (gain >= 0.0).all()):
            raise InvalidValue(
                f"task '{self.name}', {field}: {gain.tolist()} given, numbers >= 0 expected"
            )
        return gain
