"""Requests for a time far ahead: they wait in the order of their starts, up to a number."""

from __future__ import annotations

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy import (
    Transition,
    TransitionPhase,
    TransitionSchedule,
    matrix_from_hierarchy,
)
from ghc_controller.hierarchy.transition_schedule import MOST_PENDING
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.references.schedule import MOST_POINTS, MOST_WAITING, ReferenceSchedule
from ghc_mpc_constraints import ContactSchedule
from ghc_mpc_constraints.schedules import schedule_inbox

TASKS = ("hand", "posture")
FAR = 1e6  # [s]


def _to(start: float) -> Transition:
    return Transition(matrix_from_hierarchy(TASKS, "posture > hand"), start, 0.1, id=f"{start}")


def _references() -> tuple[ReferenceSchedule, ghc.Task]:
    robot = ghc.load_robot("kuka_lwr")
    schedule = ReferenceSchedule(robot.tasks)
    schedule.begin(robot.model)
    return schedule, robot.tasks[0]


def _reference(task: ghc.Task, start: float, points: int = 1) -> ReferenceTrajectory:
    times, position = np.arange(float(points)), np.full((points, 3), start)
    return ReferenceTrajectory(task.name, task.space, 3, times, position, start_time=start)


def test_transitions_ahead_are_rejected_from_a_number_on_and_start_in_order() -> None:
    schedule = TransitionSchedule(matrix_from_hierarchy(TASKS, "hand > posture"), lambda _: 1.0)
    starts = np.random.default_rng(0).integers(1, 50, MOST_PENDING).astype(float)
    for start in starts:
        schedule.check_solvable(_to(start))
        schedule.add(_to(start), 0.0)
    with pytest.raises(InvalidValue, match=f"start 1e\\+06 s given; {MOST_PENDING} transitions"):
        schedule.add(_to(FAR), 0.0)
    events = schedule.advance(100.0)
    begun = [e.transition.start for e in events if e.phase is TransitionPhase.ACTIVE]
    assert begun == sorted(starts.tolist())
    assert schedule.is_settled
    schedule.add(_to(FAR), 100.0)


def test_references_ahead_are_rejected_from_a_number_on_and_apply_in_order() -> None:
    schedule, task = _references()
    starts = np.random.default_rng(1).permutation(MOST_WAITING + 1).astype(float)
    for start in starts:
        schedule.add(_reference(task, start))
    with pytest.raises(InvalidValue, match=f"{MOST_WAITING} references wait"):
        schedule.add(_reference(task, FAR))
    for time in (0.5, 3.0, 3.5, 700.2, 2000.0):
        expected = np.floor(min(time, MOST_WAITING))
        assert schedule.peek(task.name, time).position[0] == expected
        assert schedule.current(task.name, time).position[0] == expected
    schedule.add(_reference(task, FAR))


def test_points_of_references_ahead_are_counted_and_forgotten_with_them() -> None:
    schedule, task = _references()
    schedule.add(_reference(task, 1.0, MOST_POINTS))
    with pytest.raises(InvalidValue, match=f"those that wait have {MOST_POINTS}, at most"):
        schedule.add(_reference(task, 2.0))
    schedule.reset()
    schedule.add(_reference(task, 1.0, MOST_POINTS - 1))
    schedule.add(_reference(task, 2.0))
    schedule.current(task.name, 3.0)
    schedule.add(_reference(task, 4.0, 1000))


def test_schedules_ahead_are_rejected_from_a_number_on() -> None:
    inbox, most = schedule_inbox.ScheduleInbox(lockstep=False), schedule_inbox.MOST_WAITING
    for k in range(most):
        inbox.put(
            ContactSchedule.checked("foot", [9.0], [0.0], [1.0], known_from=FAR + k), 0.0, True
        )
    late = ContactSchedule.checked("foot", [9.0], [0.0], [1.0])
    with pytest.raises(InvalidValue, match=f"'foot': {most} schedules wait"):
        inbox.put(late, 0.0, True)
    assert len(inbox.due(FAR)) == 1
    assert inbox.put(late, 0.0, True)
    assert inbox.due(0.0) == [late]
