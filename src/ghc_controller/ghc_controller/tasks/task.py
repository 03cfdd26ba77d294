"""What a task is: an error, a Jacobian and a drift (section 3 of ghc_2015)."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.migration.names import Kind, hint
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import Follower
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.force_control import ForceControl
from ghc_controller.tasks.memory import TaskMemory
from ghc_controller.types import Array, TaskRows, TaskTarget


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
    """Measures a task variable xi against its reference xi*: e = xi* - xi, xi' = J v.

    With xi'' = J dv + J' v (eq. 2) that is all a controller needs to know of it: the law that
    makes accelerations of errors is the same for all tasks (tasks/law.py), and solvers on velocity
    level use e and J alone.

    A new kind of task is one new file in this folder: a subclass of Task that implements
    `measure`, `current` and `from_config`, under the decorator `@register_task("kind")` of
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
        stiffness: ArrayLike,
        damping: ArrayLike,
        reference: ArrayLike | None = None,
    ) -> None:
        """Store gains (one number or one per row) and an optional standing reference.

        Raises:
            InvalidValue: a gain or reference is not finite, or a gain is negative.
            WrongSize: as many gains or reference entries as rows are expected.
        """
        super().__init__(name, labels, None if reference is None else np.asarray(reference))
        self.stiffness = self._gain("stiffness", stiffness)
        self.damping = self._gain("damping", damping)

    def __init_subclass__(cls, **keywords: Any) -> None:
        """Raise TypeError for a kind that is written as in earlier versions."""
        super().__init_subclass__(**keywords)
        for name in vars(cls):
            words = hint(Kind.METHOD, f"Task.{name}")
            if words:
                raise TypeError(f"{cls.__qualname__}.{name}: {words}")

    @property
    def force_row_mask(self) -> NDArray[np.bool_]:
        """(m,) rows that follow a force while TaskStack.force_rows of this task is > 0."""
        if self.force is None:
            return np.zeros(self.size, dtype=np.bool_)
        return self.force.force_rows

    @classmethod
    @abstractmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Task:
        """Build from one entry of `tasks` in robot.yaml (`kind` is already read)."""

    @abstractmethod
    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:
        """Write error, Jacobian and drift at the state of the last `model.update`.

        `out` has the velocity and acceleration of the reference and the gains of the task, which
        most kinds leave alone. One whose reference is no point of xi also writes the velocity and
        acceleration that the rows shall have; one whose gains depend on the state writes these.

        Args:
            reference: at this instant, with sizes as `check_target` wants them.
            out: arrays of m rows, such as a block of a TaskStack. They begin with zeros and keep
                what this task wrote before.
        """

    def measured(self, model: RobotModel, reference: TaskTarget) -> TaskRows:
        """Fresh rows that hold error, Jacobian and drift at the last `model.update`."""
        rows = TaskRows.zeros(self.size, model.nv)
        self.measure(model, reference, rows)
        return rows

    def as_reference(self, model: RobotModel, values: Array) -> Array:  # noqa: ARG002
        """Rates or accelerations of the rows (m,) in the axes of a reference's, (m,)."""
        return values

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

    def copy(self) -> Self:
        """The same task with gains of its own; what it accumulates is in its memory."""
        copied = copy(self)
        copied.stiffness, copied.damping = self.stiffness.copy(), self.damping.copy()
        return copied

    def make_memory(self) -> TaskMemory | None:
        """Empty memory for whoever follows this task over time; None where there is none."""
        return None if self.force is None else self.force.make_memory()

    def __repr__(self) -> str:
        """Kind, name and rows."""
        return f"{type(self).__name__}({self.name!r}, rows={list(self.labels)})"

    def _gain(self, field: str, value: ArrayLike) -> Array:
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
