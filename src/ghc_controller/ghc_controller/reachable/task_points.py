"""Points of a task reference along a motion of the joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.reachable.held_base import HeldBase
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array


def task_references(
    robot: HeldBase, tasks: Sequence[Task], times: Array, motion: Array
) -> tuple[ReferenceTrajectory, ...]:
    """One trajectory per task through xi, J v and J a + dJ/dt v.

    Args:
        times: (p,) [s], increasing.
        motion: (p, 3, n) q, v, a of the joints at these times.
    """
    points: list[list[tuple[Array, Array, Array]]] = [[] for _ in tasks]
    for q, v, a in motion:
        robot.update(q, v)
        for task, found in zip(tasks, points, strict=True):
            position = task.current(robot.model)
            rows = task.measured(robot.model, task.static_target(position))
            J = robot.columns(rows.jacobian)
            velocity = task.as_reference(robot.model, J @ v)
            acceleration = task.as_reference(robot.model, J @ a + rows.drift)
            found.append((position, velocity, acceleration))
    references = []
    for task, found in zip(tasks, points, strict=True):
        positions, velocities, accelerations = (np.array(c) for c in zip(*found, strict=True))
        references.append(
            ReferenceTrajectory.for_task(
                task,
                times - times[0],
                positions,
                velocities,
                accelerations,
                start_time=float(times[0]),
            )
        )
    return tuple(references)
