"""Long serial chains: a URDF made on the fly, and problems with active bounds in random states."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

import ghc_controller as ghc
from benchmarks.random_tasks import Reach, random_references, strict_matrix
from ghc_controller.types import Array, Bounds

SEED = 17
REGIMES = ("few", "many")  # joints whose torque bound the free optimum breaks
_LENGTH, _MASS = 0.1, 0.5  # [m], [kg] of a link
_AXES = ("0 0 1", "0 1 0", "1 0 0")  # of the joints, in turn
_RANGE = 0.8  # [rad] of the random postures; limits are 2.5
_TASKS = ("end", "middle", "posture", "end_orientation", "quarter")  # the first 3 to 5 are used


class ChainProblem(NamedTuple):
    """One problem; every bound holds at x = 0."""

    regime: str
    levels: int
    problem: ghc.ControlProblem


def chain_controller(joints: int) -> ghc.Controller:
    """Controller of a chain of that many revolute joints, five tasks, fixed base."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "chain.urdf").write_text(_urdf(joints), encoding="utf-8")
        (folder / "robot.yaml").write_text(_robot(joints), encoding="utf-8")
        robot = ghc.load_robot(folder / "robot.yaml")
    return ghc.Controller(robot, ghc.Settings(torque_rate_limit=0.0))


def chain_problems(
    controller: ghc.Controller, free: ghc.Formulation, count: int
) -> Iterator[ChainProblem]:
    """The first `count` problems of a chain; `free` finds the optima that size the bounds.

    Random posture within 0.8 rad, v = 0, random targets, strict order of 3 to 5 tasks (in turn).
    Torque bounds about the bias: 0.3 to 1.5 of the free optimum's torque of each joint (many), or
    0.3 to 1.0 of the largest torque for all joints (few). In every second pair of problems
    accelerations are bounded as well, by 0.3 to 1.0 of the largest one.
    """
    rng = np.random.default_rng(SEED)
    model = controller.model
    for number in range(count):
        levels = 3 + number // 4 % 3
        controller.reset()
        q = rng.uniform(-_RANGE, _RANGE, model.nv)
        controller.observe(ghc.RobotState(0.0, q, np.zeros(model.nv)))
        for reference in random_references(controller.robot, rng, Reach()):
            controller.add_reference(reference)
        order = rng.permutation(levels)
        matrix = ghc.PriorityMatrix(controller.robot.task_names, strict_matrix(order, len(_TASKS)))
        controller.add_transition(ghc.Transition(matrix, 0.0, 0.0), 0.0)
        for time in (0.0, 1e-3):
            controller.step(ghc.RobotState(time, q, np.zeros(model.nv)))
        regime = REGIMES[number % 2]
        bounded = number // 2 % 2 == 1
        yield ChainProblem(
            regime, levels, _bounded(controller.problem(), free, regime, bounded, rng)
        )


def _bounded(
    problem: ghc.ControlProblem,
    free: ghc.Formulation,
    regime: str,
    bound_accelerations: bool,
    rng: np.random.Generator,
) -> ghc.ControlProblem:
    n, bias = len(problem.bias), problem.bias
    none = Bounds(np.full(n, -np.inf), np.full(n, np.inf))
    optimum = free.solve(
        replace(problem, acceleration=none, torque=none, torque_limit=none)
    ).acceleration
    torque = np.abs(problem.mass_matrix @ optimum)
    if regime == "many":
        size: Array = rng.uniform(0.3, 1.5, n) * torque + 1e-3 * torque.max()
    else:
        size = np.full(n, rng.uniform(0.3, 1.0) * torque.max())
    box = np.full(n, np.inf)
    if bound_accelerations:
        box = np.full(n, rng.uniform(0.3, 1.0) * np.abs(optimum).max())
    limits = Bounds(bias - size, bias + size)
    return replace(problem, acceleration=Bounds(-box, box), torque=limits, torque_limit=limits)


def _urdf(joints: int) -> str:
    inertia = _MASS * _LENGTH**2 / 12.0
    parts = ['<robot name="chain">', '<link name="base"/>']
    for i in range(1, joints + 1):
        parts.append(
            f'<link name="link_{i}"><inertial><origin xyz="0 0 {0.5 * _LENGTH}"/>'
            f'<mass value="{_MASS}"/><inertia ixx="{inertia:.4g}" iyy="{inertia:.4g}" '
            f'izz="{0.1 * inertia:.4g}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        )
        parent, height = ("base", 0.0) if i == 1 else (f"link_{i - 1}", _LENGTH)
        parts.append(
            f'<joint name="joint_{i}" type="revolute"><parent link="{parent}"/>'
            f'<child link="link_{i}"/><origin xyz="0 0 {height}"/><axis xyz="{_AXES[i % 3]}"/>'
            '<limit lower="-2.5" upper="2.5" effort="1e5" velocity="5"/></joint>'
        )
    return "\n".join([*parts, "</robot>"])


def _robot(joints: int) -> str:
    gains = "stiffness: 30.0, damping: 20.0"
    frames = {"end": joints, "middle": joints // 2, "quarter": joints // 4}
    entries = {
        name: f"{{name: {name}, kind: frame_position, frame: link_{frame}, {gains}}}"
        for name, frame in frames.items()
    }
    entries["posture"] = f"{{name: posture, kind: posture, {gains}}}"
    entries["end_orientation"] = (
        f"{{name: end_orientation, kind: frame_orientation, frame: link_{joints}, {gains}}}"
    )
    tasks = "\n".join(f"  - {entries[name]}" for name in _TASKS)
    return (
        "name: chain\nurdf: chain.urdf\nfloating_base: false\n"
        f'tasks:\n{tasks}\nhierarchy: "{" > ".join(_TASKS)}"\n'
    )
