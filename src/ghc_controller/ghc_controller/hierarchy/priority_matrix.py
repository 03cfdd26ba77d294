"""The priority matrix: how strictly each task has priority over every other one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True, eq=False)
class PriorityMatrix:
    """Validated priorities between named tasks (GHC paper, eq. 4 and section 4.2.1).

    `alpha[i, j]` = 1: task j has strict priority over task i; 0: j does not restrict i; in
    between: i moves partly along the directions of j. `alpha[i, i]` = 1 removes task i.
    """

    tasks: tuple[str, ...]
    alpha: Array  # (k, k) in [0, 1], read-only

    def __post_init__(self) -> None:
        alpha = np.array(self.alpha, dtype=np.float64)
        k = len(self.tasks)
        if len(set(self.tasks)) != k:
            raise InvalidValue(f"task names must differ; given: {', '.join(self.tasks)}")
        if alpha.shape != (k, k):
            raise WrongSize(
                f"priority matrix of tasks {', '.join(self.tasks)}", alpha.shape, (k, k)
            )
        if not np.isfinite(alpha).all() or (alpha < 0.0).any() or (alpha > 1.0).any():
            i, j = np.argwhere(~((alpha >= 0.0) & (alpha <= 1.0)))[0]
            raise InvalidValue(
                f"alpha[{self.tasks[i]}, {self.tasks[j]}] = {alpha[i, j]} given, "
                "a number in [0, 1] expected"
            )
        alpha.setflags(write=False)
        object.__setattr__(self, "alpha", alpha)

    @classmethod
    def from_rows(
        cls, known_tasks: Sequence[str], tasks: Sequence[str], alpha: Sequence[float]
    ) -> PriorityMatrix:
        """Matrix over `known_tasks` from row-major `alpha` over `tasks`; the others are removed.

        Raises:
            UnknownName: a task that does not exist.
            WrongSize: `alpha` does not have len(tasks)**2 entries.
            InvalidValue: a task named twice, or an entry outside [0, 1].
        """
        for name in tasks:
            if name not in known_tasks:
                raise UnknownName("task", name, known_tasks)
        if len(alpha) != len(tasks) ** 2:
            raise WrongSize(
                f"alpha of {len(tasks)} tasks ({', '.join(tasks)})", len(alpha), len(tasks) ** 2
            )
        part = cls(
            tuple(tasks), np.reshape(np.asarray(alpha, dtype=np.float64), (len(tasks),) * 2)
        )
        index = [list(known_tasks).index(name) for name in tasks]
        full = np.ones((len(known_tasks),) * 2)
        full[np.ix_(index, index)] = part.alpha
        return cls(tuple(known_tasks), complete_removals(full))


def complete_removals(alpha: Array) -> Array:
    """Set the row of a removed task to 1 and its column to 0 in the other rows.

    With zeros in its row the variable nu'_i of a removed task would still absorb constraint
    forces; with its column unchanged the task would still block directions of others.
    """
    alpha = alpha.copy()
    removed = np.flatnonzero(np.diag(alpha) >= 1.0)
    active = np.flatnonzero(np.diag(alpha) < 1.0)
    alpha[removed, :] = 1.0
    alpha[np.ix_(active, removed)] = 0.0
    return alpha
