"""The priority matrix: how far each task is projected out of every other one."""

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
            WrongSize: `alpha` has not len(tasks)**2 entries.
            InvalidValue: a task named twice, or an entry that is no number in [0, 1].
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

    def strictly_dominates(self, upper: str, lower: str) -> bool:
        """True where `upper` has strict priority over `lower`, and not the other way round."""
        i, j = self.tasks.index(lower), self.tasks.index(upper)
        return bool(self.alpha[i, j] == 1.0 and self.alpha[j, i] == 0.0)


def complete_removals(alpha: Array) -> Array:
    """Row of a removed task 1, its column 0 in the rows of the others.

    With 0 elsewhere in its row a removed task's variable nu'_i would still absorb constraint
    forces; with its column kept it would still block the directions of others.
    """
    alpha = alpha.copy()
    removed = np.flatnonzero(np.diag(alpha) >= 1.0)
    active = np.flatnonzero(np.diag(alpha) < 1.0)
    alpha[removed, :] = 1.0
    alpha[np.ix_(active, removed)] = 0.0
    return alpha
