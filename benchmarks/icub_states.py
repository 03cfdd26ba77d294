"""iCub standing on both feet with ten tasks in random strict order: states and their problems."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

import ghc_controller as ghc
from benchmarks.models import install_model
from benchmarks.random_tasks import Reach, random_references, strict_matrix
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator

SEED = 21
SCENE = "icub_standing"
_LEGS = ("hip", "knee", "ankle")  # they stay, so that both feet stand
_CALM = ("torso", "neck")
_INSIDE = 0.02  # [rad] distance from position limits


class TenTasks(NamedTuple):
    """One state at rest with its targets and order."""

    q: Array  # (nq,)
    references: tuple[ghc.ReferenceTrajectory, ...]
    order: tuple[int, ...]  # tasks, highest first


def icub_controller(formulation: str) -> ghc.Controller:
    """Default settings but for the torque rate limit, which is off."""
    install_model("icub-models")
    return ghc.Controller.for_robot(
        "icub", ghc.Settings(formulation=formulation, torque_rate_limit=0.0)
    )


def ten_task_states(controller: ghc.Controller, count: int) -> Iterator[TenTasks]:
    """The first `count` states of the set: arms, torso and neck moved at random, v = 0."""
    rng = np.random.default_rng(SEED)
    model = controller.model
    start = Simulator(SCENE, joint_names=model.joint_names).start
    for _ in range(count):
        controller.reset()
        q = start.copy()
        for i, name in enumerate(model.joint_names):
            if not any(part in name for part in _LEGS):
                size = 0.4 if any(part in name for part in _CALM) else 0.8  # [rad]
                q[7 + i] = np.clip(
                    q[7 + i] + rng.uniform(-1, 1) * size,
                    model.position_lower[i] + _INSIDE,
                    model.position_upper[i] - _INSIDE,
                )
        controller.observe(ghc.RobotState(0.0, q, np.zeros(model.nv)))
        references = random_references(controller.robot, rng, Reach())
        order = rng.permutation(len(controller.robot.tasks))
        yield TenTasks(q, tuple(references), tuple(int(task) for task in order))


def begin(controller: ghc.Controller, case: TenTasks, alpha: Array) -> None:
    """Let a controller start at a state, with its targets and a matrix in force at time 0."""
    controller.reset()
    controller.observe(ghc.RobotState(0.0, case.q, np.zeros(controller.model.nv)))
    for reference in case.references:
        controller.add_reference(reference)
    matrix = ghc.PriorityMatrix(controller.robot.task_names, alpha)
    controller.add_transition(ghc.Transition(matrix, 0.0, 0.0), 0.0)


def ten_task_problem(controller: ghc.Controller, case: TenTasks) -> ghc.ControlProblem:
    """A copy of the control problem at a state."""
    begin(controller, case, strict_matrix(case.order, len(case.order)))
    still = np.zeros(controller.model.nv)
    for time in (0.0, 1e-3):
        controller.step(ghc.RobotState(time, case.q, still))
    return copy.deepcopy(controller.problem())
