"""Requests: hierarchy strings, matrices, transitions, references, schedules, plans."""

from __future__ import annotations

from functools import cache
from random import Random
from typing import Any

import numpy as np
from ghc_msgs.msg import (
    ConstraintPreview,
    ContactSchedule,
    ObstacleState,
    ObstacleStateArray,
    PlannedMotion,
    PriorityTransition,
    TaskReference,
    TaskReferencePoint,
)
from hypothesis import strategies as st

from benchmarks.fuzz.edits import edited
from benchmarks.fuzz.target import ODD_FLOAT, STAMP, WORD, Target
from ghc_controller import GhcError, PriorityMatrix, load_robot, matrix_from_hierarchy
from ghc_controller.errors import UnknownName
from ghc_controller.hierarchy import (
    TransitionSchedule,
    format_hierarchy,
)
from ghc_controller.previews.preview import KINDS
from ghc_controller.references.plausibility import check_plausible
from ghc_controller.ros.conversions.previews import preview_from_message
from ghc_controller.ros.conversions.requests import (
    event_message,
    reference_from_message,
    transition_from_message,
)
from ghc_mpc_constraints import ContactSchedule as Contact
from ghc_mpc_constraints import Horizon, Measurement
from ghc_mpc_constraints.ros.conversions import times_of
from ghc_mpc_constraints.schedules.raw_bounds import preview

TASKS = ("end_effector", "elbow", "posture")
PARTS = st.one_of(st.sampled_from([*TASKS, ">", "=", " > ", " = ", " ", ">>"]), WORD)
HIERARCHY = st.one_of(
    st.lists(PARTS, max_size=12).map("".join),
    st.permutations(TASKS).flatmap(
        lambda names: st.sampled_from([" > ", " = "]).map(lambda sign: sign.join(names))
    ),
    st.integers(1, 3000).map(lambda n: " > ".join(f"t{i}" for i in range(n))),
)
DOUBLES = st.lists(ODD_FLOAT, max_size=9)
HORIZON = Horizon(0.01, 30)


def parse_hierarchy(text: str) -> None:
    """A string is a matrix, which is that string again."""
    matrix = matrix_from_hierarchy(TASKS, text)
    again = matrix_from_hierarchy(TASKS, format_hierarchy(matrix))
    assert np.array_equal(again.alpha, matrix.alpha)


@st.composite
def transitions(draw: st.DrawFn) -> PriorityTransition:
    """Requests, most of them wrong in one way."""
    message = PriorityTransition(id=draw(WORD))
    kind = draw(st.integers(0, 2))
    if kind != 1:
        message.hierarchy = draw(HIERARCHY)
    if kind != 0:
        size = draw(st.integers(0, 4))
        message.tasks = draw(st.lists(st.sampled_from([*TASKS, "x"]), max_size=4))
        share = st.one_of(st.floats(0.0, 1.0), ODD_FLOAT)
        message.alpha = draw(st.lists(share, min_size=size * size, max_size=size * size))
    sound = draw(st.booleans())
    message.duration = draw(st.floats(0.0, 3.0) if sound else ODD_FLOAT)
    message.torque_rate = 0.0 if sound else draw(ODD_FLOAT)
    profiles = st.sampled_from(["", "linear", "minimum_jerk"])
    message.profile = draw(profiles if sound else WORD)
    message.header.stamp.sec, message.header.stamp.nanosec = draw(STAMP)
    return message


def follow(case: tuple[list[tuple[PriorityTransition, float]], list[float]]) -> None:
    """Requests at some times, and steps at others: alpha stays a matrix, shares add up to 1."""
    requests, times = case
    schedule = TransitionSchedule(matrix_from_hierarchy(TASKS, " > ".join(TASKS)), lambda _: 1.0)
    now = 0.0
    for k in range(max(len(requests), len(times))):
        now += times[k] if k < len(times) else 0.01
        if k < len(requests):
            try:
                wanted = transition_from_message(requests[k][0], TASKS, now + requests[k][1])
                schedule.check_solvable(wanted)
            except GhcError:
                continue
            for event in schedule.add(wanted, now):
                event_message(event)
        for event in schedule.advance(now):
            event_message(event)
        alpha = schedule.alpha
        assert ((alpha >= 0.0) & (alpha <= 1.0)).all()


def _edit_requests(case: Any, random: Random) -> Any:
    """One request, or one time: those of the simulation go on by seconds."""
    requests, times = case
    if requests and random.random() < 0.8:
        edited(requests[random.randrange(len(requests))][0], random)
    elif times:
        times[random.randrange(len(times))] = random.uniform(0.0, 2.0)
    return case


@cache
def robot() -> Any:
    """Tasks that follow references."""
    return load_robot("kuka_lwr")


@st.composite
def references(draw: st.DrawFn) -> TaskReference:
    """References of one task, sound or not."""
    message = TaskReference(task=draw(st.sampled_from(TASKS)))
    size = {"posture": 7}.get(message.task, 3)
    row: st.SearchStrategy[list[float]] = st.one_of(
        st.lists(ODD_FLOAT, min_size=size, max_size=size), st.just([]), DOUBLES
    )
    second = 0
    for _ in range(draw(st.integers(0, 5))):
        point = TaskReferencePoint(position=draw(row))
        if draw(st.booleans()):
            point.velocity = draw(row)
        if draw(st.booleans()):
            point.acceleration = draw(row)
        if draw(st.integers(0, 9)) == 0:
            point.wrench = draw(row)
        sec, nanosec = draw(STAMP)
        second += draw(st.integers(0, 2))
        point.time_from_start.sec = draw(st.sampled_from([second, sec]))
        point.time_from_start.nanosec = nanosec
        message.points.append(point)
    if draw(st.integers(0, 4)) == 0:
        names = [f"joint_{i}" for i in range(1, 8)]
        message.joints = draw(st.one_of(st.permutations(names), st.lists(WORD, max_size=8)))
    message.header.stamp.sec, message.header.stamp.nanosec = draw(STAMP)
    return message


def refer(message: TaskReference) -> None:
    """What is accepted can be followed at any time."""
    known = robot()
    tasks = {task.name: task for task in known.tasks}
    if message.task not in tasks:
        raise UnknownName("task", message.task, tasks)
    task = tasks[message.task]
    current = np.zeros(task.position_size)
    reference = reference_from_message(message, task, current, 1.0)
    check_plausible(task, reference, known.model.limits, known.model.joint_names)
    middle = 0.5 * (reference.start_time + reference.end_time)
    for time in (reference.start_time, middle, reference.end_time, reference.end_time + 1.0):
        assert np.isfinite(reference.target(time).position).all()


@st.composite
def schedules(draw: st.DrawFn) -> ContactSchedule:
    """Schedules of a contact."""
    message = ContactSchedule(contact=draw(st.sampled_from(["left", "right", ""])))
    message.header.stamp.sec, message.header.stamp.nanosec = draw(STAMP)
    message.known_from.sec, message.known_from.nanosec = draw(STAMP)
    count = draw(st.integers(1, 5))
    times = st.lists(st.floats(0.0, 5.0), min_size=count, max_size=count, unique=True).map(sorted)
    force = st.lists(st.floats(0.0, 100.0), min_size=count, max_size=count)
    message.times = draw(st.one_of(times, DOUBLES))
    message.lower = draw(st.one_of(force, DOUBLES))
    message.upper = draw(st.one_of(force, DOUBLES))
    return message


def plan_of(message: ContactSchedule) -> None:
    """What is accepted can be looked ahead in."""
    start, known_from = times_of(message, 1.0)
    (schedule,) = Contact.read(message, start, ("left", "right"))
    bounds = preview(schedule.known_at(known_from), 1.0, HORIZON)
    assert np.isfinite(bounds.lower).all()
    assert (bounds.lower <= bounds.upper).all()
    (later,) = Contact.read(message, 2.0)
    schedule.followed_by(later, 1.5).at(1.7)


@st.composite
def previews(draw: st.DrawFn) -> ConstraintPreview:
    """Bounds of rows that a generator plans."""
    count, points = draw(st.integers(0, 3)), draw(st.integers(0, 4))
    message = ConstraintPreview(step=draw(st.one_of(st.just(0.01), ODD_FLOAT)))
    message.kind, message.name = draw(st.one_of(st.sampled_from(KINDS), WORD)), draw(WORD)
    message.points = draw(st.sampled_from([points, points, points, 2**32 - 1]))
    message.interpolate = draw(st.booleans())
    sound = draw(st.booleans())
    number = st.floats(0.0, 50.0) if sound else ODD_FLOAT
    size = st.just(count * points) if sound else st.integers(0, 12)
    for field in ("lower", "upper"):
        length = draw(size)
        setattr(message, field, draw(st.lists(number, min_size=length, max_size=length)))
    message.rows = [f"c{i}" for i in range(count)]
    message.active = message.conflict = [True] * (count if sound else draw(st.integers(0, 4)))
    highest = 3 if sound else 255
    message.status = draw(st.lists(st.integers(0, highest), min_size=count, max_size=count))
    message.stale_rule = draw(st.integers(0, highest))
    return message


@st.composite
def motions(draw: st.DrawFn) -> ConstraintPreview:
    """Motions of obstacles that a generator plans."""
    message = ConstraintPreview(kind="obstacle_motion")
    message.step = draw(st.one_of(st.just(0.01), ODD_FLOAT))
    message.points = draw(st.integers(0, 4))
    three = st.lists(ODD_FLOAT, min_size=3, max_size=3)
    for _ in range(draw(st.integers(0, 3))):
        entry = PlannedMotion(id=draw(WORD), protected_frame=draw(WORD))
        for field in ("position", "velocity", "acceleration"):
            getattr(entry, field)[:] = draw(three)
        entry.normal[:] = draw(st.one_of(st.just([1.0, 0.0, 0.0]), three))
        entry.safe_distance = draw(ODD_FLOAT)
        entry.jerk = draw(DOUBLES)
        entry.status = draw(st.integers(0, 255))
        message.motions.append(entry)
    return message


def read_preview(message: ConstraintPreview) -> None:
    """As the controller reads a preview; what is accepted has bounds at every time."""
    found = preview_from_message(message, 1.0)
    for time in (0.0, 1.005, 1e9):
        assert all(bounds.shape == (len(found.rows),) for bounds in found.at(time))
        for row in range(len(found.motions)):
            assert np.isfinite(found.motion_at(row, min(time, 2.0))).all()


@st.composite
def readings(draw: st.DrawFn) -> ObstacleStateArray:
    """What a sensor saw."""
    message = ObstacleStateArray()
    message.header.stamp.sec, message.header.stamp.nanosec = draw(STAMP)
    three = st.lists(ODD_FLOAT, min_size=3, max_size=3)
    for _ in range(draw(st.integers(0, 3))):
        entry = ObstacleState(id=draw(WORD), protected_frame=draw(WORD))
        entry.position[:] = draw(three)
        entry.normal[:] = draw(st.one_of(st.just([1.0, 0.0, 0.0]), three))
        entry.distance, entry.safe_distance = draw(ODD_FLOAT), draw(ODD_FLOAT)
        message.obstacles.append(entry)
    return message


def measure(message: ObstacleStateArray) -> None:
    """As a generator reads a sensor."""
    for entry in message.obstacles:
        Measurement.read(entry)


def targets() -> tuple[Target, ...]:
    """All of this file."""
    steps = st.lists(st.floats(0.0, 2.0), max_size=6)
    asked = st.lists(st.tuples(transitions(), st.floats(-1.0, 2.0)), max_size=4)
    return (
        Target("hierarchy_string", HIERARCHY, parse_hierarchy),
        Target(
            "priority_matrix",
            st.tuples(st.lists(st.sampled_from([*TASKS, "x"]), max_size=4), DOUBLES),
            lambda case: PriorityMatrix.from_rows(TASKS, *case) and None,
        ),
        Target(
            "transition_request",
            transitions(),
            lambda m: transition_from_message(m, TASKS, 1.0) and None,
        ),
        Target("transition_logic", st.tuples(asked, steps), follow, edit=_edit_requests),
        Target("task_reference", references(), refer),
        Target("contact_schedule", schedules(), plan_of),
        Target("preview_of_bounds", previews(), read_preview),
        Target("preview_of_motions", motions(), read_preview),
        Target("obstacle_reading", readings(), measure),
    )
