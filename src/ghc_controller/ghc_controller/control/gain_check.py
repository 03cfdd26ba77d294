"""Gains that the control period cannot carry: they diverge, whatever the robot."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array


def check_gains(tasks: Iterable[Task], control_dt: float) -> None:
    """Raise InvalidValue, with task, gains and bound, for the first task that diverges."""
    for index, task in enumerate(tasks):
        check_gain(
            f"tasks[{index}].damping of '{task.name}'", task.stiffness, task.damping, control_dt
        )


def check_gain(field: str, stiffness: Array, damping: Array, control_dt: float) -> None:
    """Reject gains (m,) [1/s^2], [1/s] whose error grows when sampled at `control_dt` [s].

    e'' = -k e - d e', held over a period and integrated as v+ = v + dt a, e+ = e + dt v+: by
    Jury's criterion stable only if 2 d dt + k dt^2 < 4.

    Raises:
        InvalidValue: names `field`, what was given and expected.
    """
    size = 2.0 * damping * control_dt + stiffness * control_dt**2
    worst = int(np.argmax(size)) if size.size else 0
    if size.size and not size[worst] < 4.0:
        k, d = float(stiffness[worst]), float(damping[worst])
        raise InvalidValue(
            f"{field}: {d:g} given with stiffness {k:g}; at control_dt = {control_dt:g} s "
            f"2 damping control_dt + stiffness control_dt^2 < 4 expected ({size[worst]:.3g} "
            "given): with more the sampled task diverges"
        )


def check_velocity_damping(damping: float, control_dt: float) -> None:
    """Reject a kd [1/s] that makes motions grow that no task claims.

    x = -kd v, held over a period: v+ = (1 - kd dt) v.

    Raises:
        InvalidValue: says what was given and expected.
    """
    if not damping * control_dt < 2.0:
        raise InvalidValue(
            f"velocity_damping: {damping:g} given; less than 2 / control_dt = "
            f"{2.0 / control_dt:g} 1/s expected: with more, motions that no task claims diverge"
        )


def check_obstacle_horizon(horizon: float, control_dt: float) -> None:
    """Reject a horizon h [s] (delta t of eq. 4.2) whose row makes a distance diverge.

    A row in force asks for d'' = 2 / h^2 (d_s - d) - 2 / h d': gains as in `check_gain`.

    Raises:
        InvalidValue: says what was given and expected.
    """
    share = control_dt / horizon
    if not 4.0 * share + 2.0 * share * share < 4.0:  # a power of a float raises where it overflows
        raise InvalidValue(
            f"obstacle_horizon: {horizon:g} given; more than (1 + sqrt(3)) / 2 control_dt = "
            f"{(1.0 + 3.0**0.5) / 2.0 * control_dt:.4g} s expected: with less, the distance "
            "diverges"
        )
