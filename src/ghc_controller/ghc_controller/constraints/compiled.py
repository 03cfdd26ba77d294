"""Boxes that the compiled core writes: all of a space in one call, or one by itself."""

from __future__ import annotations

from ghc_controller.constraints.constraint import BoxConstraint, Tick
from ghc_controller.core import JointBox
from ghc_controller.types import Array


class CompiledBox(BoxConstraint):
    """A box constraint with a box of the core.

    A subclass that brings a `write` of its own is written by that, like any constraint in Python.

    Attributes:
        core: its box.
        changes: whether `prepare` has to tell it what the bounds are.
    """

    core: JointBox
    changes: bool = False

    def prepare(self, time: float) -> None:
        """Tell the core what the bounds are at `time` [s]."""

    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """See BoxConstraint."""
        self.prepare(tick.state.time)
        self.core.write(tick.model.core, tick.previous_torque, tick.dt, tick.jerk, lower, upper)


def written_by_core(constraint: BoxConstraint) -> JointBox | None:
    """The box of a constraint whose `write` is that of the core."""
    if isinstance(constraint, CompiledBox) and type(constraint).write is CompiledBox.write:
        return constraint.core
    return None
