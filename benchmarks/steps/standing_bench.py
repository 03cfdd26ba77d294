"""Time per control step of the standing humanoid: floating base, both feet in contact."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.steps.pace import Pace
from benchmarks.steps.states import DT, Segment
from benchmarks.steps.timed_controller import TimedController, Variant
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.programs.markdown import table
from tools.model_packages import install_missing
from tools.workspace.layout import Layout

SCENE = "icub_standing"
TITLE = "iCub, 38 DoF, standing on both feet"
TASKS = ("center_of_mass", "root_orientation", "left_hand", "right_hand", "posture")
VARIANTS = tuple(
    Variant(name, "daqp") for name in ("cascade", "ghc", "balanced", "hqp", "weighted")
)
_REACH = 0.05  # [m] targets of the hands, this far from where they start


def run_standing_bench(
    layout: Layout,
    segments: int,
    length: int,
    rounds: int,
    pace: Pace,
    tell: Callable[[str], None],
) -> Iterator[dict[str, Any]]:
    """One row per number of tasks and formulation; states of a simulated closed loop."""
    install_missing("icub-models", layout)
    tell(f"{TITLE}: states in which to measure")
    for count in range(1, len(TASKS) + 1):
        states = simulated(count, segments, length)
        timed = [TimedController(_config(count), variant, None) for variant in VARIANTS]
        for controller in timed:
            for segment in states:
                controller.watch(segment)
        rng = np.random.default_rng(count)
        tell(f"{TITLE}: {count} tasks")
        for _ in range(rounds):
            pace.take()
            for segment in states:
                for index in rng.permutation(len(timed)):
                    timed[index].follow(segment)
        for controller in timed:
            yield {"tasks": count, **controller.summary()}


def standing_table(rows: Sequence[dict[str, Any]]) -> str:
    """Median (p99) [us] and QPs per step of every formulation against the number of tasks."""
    names = list(dict.fromkeys(row["formulation"] for row in rows))
    lines = []
    for count in dict.fromkeys(row["tasks"] for row in rows):
        mine = {row["formulation"]: row for row in rows if row["tasks"] == count}
        times = [
            f"{mine[n]['median_us']:.0f} ({mine[n]['p99_us']:.0f}), {mine[n]['qps']:.1f}"
            for n in names
        ]
        lines.append([str(count), *times])
    return table(["tasks", *names], lines)


def standing_section(rows: Sequence[dict[str, Any]]) -> str:
    """The section of the document."""
    if not rows:
        return ""
    return (
        f"## {TITLE}\n\n"
        "Floating base and eight contact points with friction pyramids. States of a closed loop\n"
        "in MuJoCo, hands on the move; model terms included. Tasks, in strict order:\n"
        f"{', '.join(TASKS)};\nwith fewer of them the first ones and the "
        "posture. Median (p99) in microseconds, and\nQPs per step: `cascade` and `hqp` solve "
        "none where no bound is reached. The paper states\n88 ms for five tasks at 32 DoF, in "
        "C++.\n\n" + standing_table(rows) + "\n"
    )


def _config(count: int) -> ghc.Robot:
    names = (*TASKS[: count - 1], TASKS[-1])
    robot = ghc.load_robot("icub")
    tasks = {task.name: task for task in robot.tasks}
    chosen = tuple(tasks[name] for name in names)
    return replace(robot, tasks=chosen, hierarchy=" > ".join(names))


def simulated(count: int, segments: int, length: int) -> list[Segment]:
    """States of a closed loop in MuJoCo with the first tasks, hands on the move."""
    robot = _config(count)
    simulator = Simulator(SCENE, DT, DT, joint_names=robot.model.joint_names)
    controller = ghc.Controller(robot, ghc.Settings(control_dt=DT, torque_rate_limit=0.0))
    rng = np.random.default_rng(0)
    found = []
    for _ in range(segments):
        start = simulator.state()
        state = ghc.RobotState(0.0, start.q, start.v)
        controller.reset()
        controller.observe(state)
        goals = []
        for task in robot.tasks:
            position = task.current(controller.model)
            if task.name.endswith("hand"):
                position = position + rng.uniform(-_REACH, _REACH, 3)
            goals.append(ghc.ReferenceTrajectory.static(task, task.static_target(position)))
        for goal in goals:
            controller.add_reference(goal)
        states = []
        for step in range(length):
            now = simulator.state()
            state = ghc.RobotState(step * DT, now.q, now.v)
            states.append(state)
            simulator.step(controller.step(state).torque)
        found.append(Segment(tuple(goals), tuple(states)))
    return found
