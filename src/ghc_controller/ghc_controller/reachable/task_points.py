"""Points of a task reference along a motion of the joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array


def task_references(
    model: RobotModel, tasks: Sequence[Task], times: Array, motion: Array
) -> tuple[ReferenceTrajectory, ...]:
    """One trajectory per task through xi, J v and J a + dJ/dt v.

    Args:
        times: (p,) [s], increasing.
        motion: (p, 3, n) q, v, a at these times; a robot with a fixed base.
    """
    points: list[list[tuple[Array, Array, Array]]] = [[] for _ in tasks]
    for q, v, a in motion:
        model.update(q, v)
        for task, found in zip(tasks, points, strict=True):
            position = task.current(model)
            rows = task.measured(model, task.static_target(position))
            found.append((position, rows.jacobian @ v, rows.jacobian @ a + rows.drift))
    references = []
    for task, found in zip(tasks, points, strict=True):
        position, velocity, acceleration = (np.array(c) for c in zip(*found, strict=True))
        references.append(
            ReferenceTrajectory.for_task(
                task,
                times - times[0],
                position,
                velocity,
                acceleration,
                start_time=float(times[0]),
            )
        )
    return tuple(references)
