"""The control law of the tasks: one function for the rows of all of them.

Another law is another function of the same arguments, given to TaskStack or set as its `law`. One
that accumulates something, such as an integral of errors, is an object with `__call__` and
`reset`, which the stack resets with itself.
"""

from __future__ import annotations

from collections.abc import Callable

from ghc_controller.core import track
from ghc_controller.types import Array, TaskRows

# (measured rows of all tasks, v (n,), simulated time [s]) -> writes rows.target
Law = Callable[[TaskRows, Array, float], None]


def tracking(rows: TaskRows, velocity: Array, time: float) -> None:  # noqa: ARG001
    """xi''_d = xi''* + kp e + kd (xi'* - J v) (section 6 of ghc_2015); target = xi''_d - J' v."""
    track(rows.jacobian, velocity, rows.vectors)
