"""Records the files in `states/`: closed loops of the default controller towards goals.

`python -m benchmarks.peers.record` writes all of them; the seeds are fixed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import ghc_controller as ghc
from benchmarks.peers.problem import Array, PeerContact, PeerProblem, PeerTask
from benchmarks.peers.robots import STANDING, bench_robot, frames_of, peer_robot
from benchmarks.steps.robots import Arm, Humanoid
from benchmarks.steps.standing_bench import simulated
from benchmarks.steps.states import Segment, closed_loop, random_goals
from benchmarks.steps.timed_controller import Variant, make_controller

STATES = Path(__file__).resolve().parent / "states"
_COUNTS = {Arm.name: (1, 3, 5), Humanoid.name: (1, 3, 5, 7)}
_SOLES = {"left_sole": "l_sole", "right_sole": "r_sole"}
_SEGMENTS, _LENGTH = 4, 25
_SHARE = 0.2  # [-] of what the tasks ask for beside gravity: the torque limit of bounded cases
_KINDS = {
    "FramePositionTask": "position",
    "FrameOrientationTask": "orientation",
    "CenterOfMassTask": "center_of_mass",
    "PostureTask": "posture",
}


def main() -> None:
    """Write every case."""
    for problem in _all():
        problem.save(STATES / f"{problem.name}.npz")
        print(f"{problem.name}: {len(problem.q)} states")


def _all() -> Iterator[PeerProblem]:
    for name, counts in _COUNTS.items():
        for count in counts:
            yield from _fixed(name, count)
    robot = peer_robot(STANDING, 5)
    segments = simulated(5, _SEGMENTS, _LENGTH)
    limit = robot.model.limits.torque
    yield _problem(f"{STANDING}_5", STANDING, robot, segments, limit, bounded=False)


def _fixed(name: str, count: int) -> tuple[PeerProblem, PeerProblem]:
    robot = peer_robot(name, count)
    start = bench_robot(name).start(robot.model)
    goals = random_goals(robot, start, np.random.default_rng(count), _SEGMENTS)
    driver = make_controller(robot, Variant("cascade", "daqp"), None)
    segments = closed_loop(driver, start, goals, _LENGTH)
    limit = robot.model.limits.torque
    free = _problem(f"{name}_{count}_free", name, robot, segments, limit, bounded=False)
    low = _reached(driver, segments)
    limited = peer_robot(name, count)
    limited.model.limits = replace(limited.model.limits, torque=low)
    driver = make_controller(limited, Variant("cascade", "daqp"), None)
    segments = closed_loop(driver, start, goals, _LENGTH)
    return free, _problem(f"{name}_{count}_bounds", name, robot, segments, low, bounded=True)


def _reached(controller: ghc.Controller, segments: list[Segment]) -> Array:
    """(a,) [Nm] symmetric limits that the tasks reach and that carry the arm everywhere."""
    gravity = np.zeros(controller.model.na)
    asked = np.full(controller.model.na, 0.1)
    for segment in segments:
        controller.reset()
        for goal in segment.goals:
            controller.add_reference(goal)
        for state in segment.states:
            torque = controller.step(state).torque
            weight = controller.model.gravity()[-controller.model.na :]
            gravity = np.maximum(gravity, np.abs(weight))
            asked = np.maximum(asked, np.abs(torque - weight))
    return gravity + _SHARE * asked


def _problem(
    title: str,
    name: str,
    robot: ghc.Robot,
    segments: list[Segment],
    torque_limit: Array,
    *,
    bounded: bool,
) -> PeerProblem:
    limits = robot.model.limits
    states = [state for segment in segments for state in segment.states]
    goals = {
        task.name: np.array([segment.goals[index].target(0.0).position for segment in segments])
        for index, task in enumerate(robot.tasks)
    }
    return PeerProblem(
        name=title,
        robot=name,
        joints=robot.model.joint_names,
        floating=robot.floating_base,
        tasks=tuple(_task(task, name) for task in robot.tasks),
        contacts=tuple(
            PeerContact(
                contact.name,
                _SOLES[contact.name],
                tuple(map(tuple, contact.points.tolist())),
                contact.friction,
                contact.force_upper,
            )
            for contact in robot.contacts
            if contact.active
        ),
        q=np.array([state.q for state in states]),
        v=np.array([state.v for state in states]),
        segment=np.repeat(np.arange(len(segments)), [len(s.states) for s in segments]),
        goals=goals,
        torque_limit=np.asarray(torque_limit),
        velocity_limit=limits.velocity,
        position_lower=limits.position_lower,
        position_upper=limits.position_upper,
        bounded=bounded,
    )


def _task(task: ghc.Task, name: str) -> PeerTask:
    kind = _KINDS[type(task).__name__]
    frame = ""
    if kind in ("position", "orientation"):
        frame = frames_of(name)[task.name]
    return PeerTask(task.name, kind, frame, float(task.stiffness[0]), float(task.damping[0]))


if __name__ == "__main__":
    main()
