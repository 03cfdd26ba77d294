"""Records the files in `states/`: ticks of every scenario with the default formulation.

`python -m benchmarks.ticks.record` writes all of them. A scenario runs as a loop through the
library: robot, references and phases of its file, without generators, schedules and wrenches,
which come over DDS. Models of robots that are not installed: `python -m tools.model_packages`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import ghc_controller as ghc
from benchmarks.compare.runs.planned import LIMITS, planned_robot, planned_transition
from benchmarks.fencing_loop import start
from benchmarks.ticks.tick_file import STATES, save
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.scenario.plan import RunOptions, RunPlan
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario, scenario_names

_KINDS = ("free", "bounded", "ramp")  # of a tick: what is kept of each scenario
_OF_KIND = 2  # ticks of a kind, at equal distances among those found
_LONGEST = 12.0  # [s] of a run: each order and each ramp is seen once in it


def main(names: list[str]) -> None:
    """Write the scenarios of these names; all of them without names."""
    STATES.mkdir(exist_ok=True)
    for name in names or scenario_names():
        found: dict[str, list[ghc.ControlProblem]] = {kind: [] for kind in _KINDS}
        for kind, problem in _ticks(name):
            found[kind].append(problem)
        kept = [problem for kind in _KINDS for problem in _spread(found[kind])]
        save(STATES / f"{name}.npz", kept)
        print(f"{name}: " + ", ".join(f"{len(_spread(found[kind]))} {kind}" for kind in _KINDS))


def _spread(problems: list[ghc.ControlProblem]) -> list[ghc.ControlProblem]:
    places = np.linspace(0, len(problems) - 1, min(_OF_KIND, len(problems)) + 2)[1:-1]
    return [problems[round(place)] for place in places]


def _ticks(name: str) -> Iterator[tuple[str, ghc.ControlProblem]]:
    """Kind and problem of 50 to 100 ticks of one run."""
    scenario = load_scenario(name)
    plan = make_plan(scenario, RunOptions(formulation=ghc.Settings().formulation), Path())
    controller = _controller(plan)
    physics_dt = plan.parameters["sim_bridge"]["physics_dt"]
    simulator = Simulator(
        scenario.scene, plan.control_dt, physics_dt, controller.model.joint_names
    )
    end = min(plan.phases[-1].end, _LONGEST)
    known = [each for each in plan.scenario.references if each.task in controller.robot.task_names]
    sampled = [replace(each, points=each.points_until(end)) for each in known]
    start(controller, simulator, replace(plan.scenario, references=tuple(sampled)))
    for planned in plan.phases:
        transition = planned_transition(planned, controller.robot.task_names)
        controller.add_transition(transition, 0.0)
    steps = round(end / plan.control_dt)
    for tick in range(steps):
        result = controller.step(simulator.state())
        if tick % max(1, steps // 60) == 7 and result.status is ghc.StepStatus.SOLVED:
            problem = controller.problem()
            ramp = len(problem.priorities.candidates) > 1
            kind = "ramp" if ramp else "bounded" if result.solution.qp_solved else "free"
            yield kind, replace(problem, second_order=None)
        simulator.step(result.torque)


def _controller(plan: RunPlan) -> ghc.Controller:
    given = plan.parameters["controller"]
    settings = ghc.Settings(
        control_dt=plan.control_dt,
        hierarchy=given.get("hierarchy", ""),
        torque_rate_limit=plan.scenario.torque_rate_limit,
        **{name: given[name] for name in LIMITS if name in given},
    )
    return ghc.Controller(planned_robot(plan), settings)


if __name__ == "__main__":
    main(sys.argv[1:])
