"""The three cases of RHP-HQP (Han et al., 2021) on the upper body of iCub: motions and orders.

The paper shows its cases in pictures and states neither paths nor thresholds; those here put the
elbow of the left arm into the way of an obstacle, as its text says.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import ghc_controller as ghc
from ghc_controller.hierarchy import Candidate, Priorities
from ghc_controller.tasks.python.frame_avoidance import FrameAvoidanceTask
from ghc_controller.types import Array

ROBOT = SCENE = "icub_upper_body"
AVOIDANCE = ("torso_avoidance", "elbow_avoidance")
FULL = "torso_avoidance > hand_orientation > hand > elbow_avoidance > posture"
RELEASED = "torso_avoidance > hand_orientation > elbow_avoidance > posture"
WAIST = "waist > hand_orientation > hand > elbow_avoidance > posture"
REACHING = "hand_orientation > hand > waist = elbow_avoidance > posture"
YIELDING = "hand_orientation > elbow_avoidance > waist > posture"
_NEAR = 0.07  # [m] of the elbow: where priorities begin to change
_NEAREST = 0.045  # [m] where they have changed
_TOWARDS = np.array([-0.19378845, 0.41519981, 0.88885047])  # of the obstacle, to the elbow
_ELBOW = np.array([-0.12604914, -0.13109879, 0.0612839])  # [m] at the start
_STRETCHED = np.array([-0.215, -0.13, 0.125])  # [m] elbow when the arm is stretched (case 3)
_REACH = np.array([-0.09, 0.0, 0.0])  # [m] from the start of the hand to its target of case 3

Knots = tuple[tuple[float, Array], ...]  # [s], [m]; at rest in each
Act = Callable[[ghc.Controller, float, float], None]  # controller, time [s], gap of the elbow [m]


@dataclass(frozen=True, slots=True)
class Case:
    """One run: where the obstacle and the hand go, and who changes priorities when."""

    name: str
    title: str
    hierarchy: str
    duration: float  # [s]
    obstacle: Knots
    hand: Knots = ()  # relative to the start of the hand [m]; empty = it stays
    schedule: Callable[[], Act] = lambda: _nothing


def prepare(case: Case, controller: ghc.Controller) -> None:
    """Give an observed controller the motions of a case."""
    robot = controller.robot
    for name in AVOIDANCE:
        controller.add_reference(_path(robot, name, case.obstacle, np.zeros(3)))
    if case.hand:
        start = _task(robot, "hand").current(robot.model)
        controller.add_reference(_path(robot, "hand", case.hand, start))


def elbow_gap(controller: ghc.Controller, time: float) -> float:
    """Distance of the elbow from the obstacle at the last observed state [m]."""
    task = _task(controller.robot, "elbow_avoidance")
    assert isinstance(task, FrameAvoidanceTask)
    return task.gap(controller.model, controller.references.current(task.name, time))


def _task(robot: ghc.Robot, name: str) -> ghc.Task:
    return robot.tasks[robot.task_names.index(name)]


def _path(robot: ghc.Robot, task: str, knots: Knots, origin: Array) -> ghc.ReferenceTrajectory:
    """Minimum-jerk motion from knot to knot: quintic, at rest in each."""
    points = np.array([origin + point for _, point in knots])
    still = np.zeros_like(points)
    times = np.array([time for time, _ in knots])
    return ghc.ReferenceTrajectory.for_task(_task(robot, task), times, points, still, still)


def _nothing(controller: ghc.Controller, time: float, gap: float) -> None:
    """A constant order."""


def _by_distance() -> Act:
    """Case 2: the share of the order without the hand follows the gap of the elbow (eq. 11)."""
    alphas: list[Array] = []

    def act(controller: ghc.Controller, time: float, gap: float) -> None:
        if not alphas:
            names = controller.robot.task_names
            alphas.extend(
                ghc.matrix_from_hierarchy(names, text).alpha for text in (FULL, RELEASED)
            )
        s = ghc.Profile.MINIMUM_JERK.progress((_NEAR - gap) / (_NEAR - _NEAREST))
        shares = zip(alphas, (1.0 - s, s), strict=True)
        mixture = Priorities.mixed(
            Candidate(alpha, share) for alpha, share in shares if share > 0.0
        )
        controller.priorities.hold(mixture, time)

    return act


def _ramp(
    controller: ghc.Controller, hierarchy: str, time: float, duration: float, kind: ghc.Profile
) -> None:
    target = ghc.matrix_from_hierarchy(controller.robot.task_names, hierarchy)
    controller.add_transition(ghc.Transition(target, time, duration, kind), time)


def _timed() -> Act:
    """Case 2 with the same ramp for every formulation."""
    left = [(1.0, RELEASED, 1.0), (3.2, FULL, 1.5)]

    def act(controller: ghc.Controller, time: float, gap: float) -> None:  # noqa: ARG001
        if left and time >= left[0][0]:
            start, hierarchy, duration = left.pop(0)
            _ramp(controller, hierarchy, start, duration, ghc.Profile.MINIMUM_JERK)

    return act


def _reactive() -> Act:
    """Case 3: release the waist; at the obstacle leave that ramp for the third order."""
    phase = [0]

    def act(controller: ghc.Controller, time: float, gap: float) -> None:
        triggers = (time > 1.6, gap < _NEAR, time > 6.4)
        ramps = ((REACHING, 2.0), (YIELDING, 0.6), (REACHING, 1.95))
        if phase[0] < 3 and triggers[phase[0]]:
            hierarchy, duration = ramps[phase[0]]
            _ramp(controller, hierarchy, time, duration, ghc.Profile.COSINE)
            phase[0] += 1

    return act


def _before(point: Array, *gaps: tuple[float, float]) -> Knots:
    return tuple((time, point - gap * _TOWARDS) for time, gap in gaps)


_PASSING = _before(_ELBOW, (0.0, 0.35), (2.0, 0.07), (3.0, 0.07), (5.0, 0.35))
CASES = {
    case.name: case
    for case in (
        Case(
            "constant", "1, constant order", FULL, 4.0, _before(_ELBOW, (0.0, 0.35), (2.5, 0.12))
        ),
        Case("distance", "2, by distance", FULL, 7.0, _PASSING, schedule=_by_distance),
        Case("ramp", "2, timed ramp", FULL, 7.0, _PASSING, schedule=_timed),
        Case(
            "reactive",
            "3, three orders",
            WAIST,
            10.0,
            _before(_STRETCHED, (0.0, 0.45), (1.8, 0.45), (3.4, 0.06), (4.6, 0.06), (6.2, 0.45)),
            ((0.3, np.zeros(3)), (2.0, _REACH)),
            _reactive,
        ),
    )
}
