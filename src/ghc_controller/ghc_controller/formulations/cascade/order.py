"""An order of tasks, and the core's workspace for it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.core import Cascade as Core
from ghc_controller.formulations.cascade.level_answers import rows_of
from ghc_controller.hierarchy.levels import is_order, levels
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.types import Array, Starts

_ORDERS_KEPT = 64


class Order(NamedTuple):
    """Rows of the tasks in the order of their levels, and the core's workspace for them."""

    rows: Starts  # (m,) indices into the augmented Jacobian
    ends: Starts  # (l,) end of each level among them
    tasks: tuple[tuple[int, ...], ...]  # of each level
    core: Core

    @classmethod
    def of(cls, alpha: Array, starts: Starts) -> Order:
        """Order of a matrix (k, k); without an active task one level that has no row."""
        tasks = tuple(tuple(level) for level in levels(alpha) or [[]])
        parts = [rows_of(starts, level) for level in tasks]
        rows, ends = np.concatenate(parts), np.cumsum([len(part) for part in parts])
        return cls(rows, ends, tasks, Core(rows.tolist(), ends.tolist()))


class Orders:
    """Orders of the matrices in use, cached, since there are few."""

    def __init__(self) -> None:
        self._known: dict[tuple[bytes, bytes], Order | None] = {}

    def forget(self) -> None:
        """Forget active sets: the next answers are those of new orders."""
        for order in self._known.values():
            if order is not None:
                order.core.forget()

    def of(self, alpha: Array, starts: Starts) -> Order | None:
        """Order of a priority matrix (k, k); None if it is not an order."""
        key = (alpha.tobytes(), starts.tobytes())
        if key not in self._known:
            if len(self._known) >= _ORDERS_KEPT:
                self._known.clear()
            order = Order.of(alpha, starts) if is_order(alpha) else None
            self._known[key] = order if np.isfinite(alpha).all() else None
        return self._known[key]

    def of_all(self, priorities: Priorities, starts: Starts) -> list[Order | None]:
        """Orders of the candidates of a mixture."""
        return [self.of(candidate.alpha, starts) for candidate in priorities.candidates]
