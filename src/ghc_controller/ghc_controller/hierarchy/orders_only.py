"""Solvability of formulations that know orders only: every other target is rejected."""

from __future__ import annotations

from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy.levels import is_order
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.types import Array


class OrdersOnly(Solvability):
    """Accepts targets that are orders: strict between levels, ties within a level, on or off."""

    __slots__ = ()

    def check(self, start: Array, target: Array, tasks: tuple[str, ...]) -> float:
        """Measure of the target.

        Raises:
            InvalidValue: it is no order; names the entries that no order has.
        """
        if not is_order(target):
            raise InvalidValue(f"{self.meaning}: {_why(target, tasks)}; {self.advice}")
        return super().check(start, target, tasks)


def orders_only(formulation: str) -> OrdersOnly:
    """Solvability of the formulation of that name."""
    return OrdersOnly(
        measure=lambda alpha: 1.0 if is_order(alpha) else 0.0,
        meaning=f"formulation '{formulation}' knows orders only",
        advice="give a hierarchy such as 'a > b = c', or use a formulation with a projector per "
        "task (ghc, balanced)",
        along_ramp=False,
    )


def _why(alpha: Array, tasks: tuple[str, ...]) -> str:
    count = len(tasks)
    for i in range(count):
        if 0.0 < alpha[i, i] < 1.0:
            return f"task '{tasks[i]}' is partly removed (alpha = {alpha[i, i]:g})"
    active = [i for i in range(count) if alpha[i, i] == 0.0]
    for i in active:
        for j in active:
            pair = (alpha[i, j], alpha[j, i])
            if i < j and pair[0] != pair[1] and pair not in ((0.0, 1.0), (1.0, 0.0)):
                return (
                    f"alpha[{tasks[i]}, {tasks[j]}] = {pair[0]:g} and "
                    f"alpha[{tasks[j]}, {tasks[i]}] = {pair[1]:g} are neither strict nor equal"
                )
    return f"the priorities of {', '.join(tasks[i] for i in active)} are not transitive"
