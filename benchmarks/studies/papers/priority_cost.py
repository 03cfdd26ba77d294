"""Cost of a step of the laws of Jeong and Chang (2009): NumPy times and operation counts."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

import ghc_controller as ghc
from benchmarks.fencing_loop import SCENARIO, fencer
from benchmarks.law_operations import COUNTS
from benchmarks.study_results import shown
from ghc_controller.formulations.baselines.operational_space import operational_space
from ghc_controller.formulations.baselines.resolved_acceleration import resolved_acceleration
from ghc_controller.formulations.baselines.strict_law import Level, levels_of
from ghc_controller.formulations.baselines.task_priority import task_priority
from ghc_controller.formulations.baselines.unifying import unifying
from ghc_controller.types import Array
from ghc_sim_bridge.programs.markdown import table as markdown_table
from ghc_sim_bridge.scenario.scenario import load_scenario

NAME = "priority_cost"
TITLE = "Cost of a step of the task-priority laws"
FORMULATIONS = ("task_priority", "resolved_acceleration", "unifying", "operational_space")
PAPER_MS = {  # section III.B.3, a Pentium of 2.4 GHz
    "task_priority": 1.4,
    "resolved_acceleration": 2.7,
    "unifying": 3.2,
    "operational_space": 4.8,
}
SEED = 5
_STATES, _QUICK = 40, 2
_REPEATS = 15  # of which the fastest counts: the machine is shared
_ROWS = (3, 2, 3, 3)  # joint limits, balance, left foot, sword tip
_W, _TOLERANCE = 1e-2, 1e-7


class _State(NamedTuple):
    """One state: levels as in the paper, and what the dynamics need."""

    order: list[Level]
    q: Array
    v: Array


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Fastest of several evaluations per state, median over the states."""
    controller = fencer(load_scenario(SCENARIO), FORMULATIONS[0], ghc.FormulationSettings())
    states = _states(controller, _QUICK if quick else _STATES)
    steps = _steps(pin.buildModelFromUrdf(str(controller.robot.urdf)))
    found = {}
    for name in formulations:
        law, dynamics = steps[name]
        parts = {"law": law, "dynamics": dynamics}
        for step in parts.values():
            step(states[0])  # loads what is loaded once
        times = {
            part: float(np.median([_fastest(step, state) for state in states]))
            for part, step in parts.items()
        }
        found[name] = {
            "law_us": times["law"],
            "dynamics_us": times["dynamics"],
            "operations": COUNTS[name](controller.model.nv, _ROWS),
        }
    facts = {"states": len(states), "seed": SEED, "joints": controller.model.nv, "rows": _ROWS}
    return {"facts": facts, "formulations": found}


def _fastest(step: Callable[[_State], object], state: _State) -> float:
    """[us]"""
    times = []
    for _ in range(_REPEATS):
        begin = perf_counter()
        step(state)
        times.append(perf_counter() - begin)
    return 1e6 * min(times)


def _states(controller: ghc.Controller, count: int) -> list[_State]:
    """Random postures in motion; as level 1 three joints stand for those near a limit."""
    rng = np.random.default_rng(SEED)
    limits, n = controller.model.limits, controller.model.nv
    states = []
    for _ in range(count):
        q = rng.uniform(limits.position_lower, limits.position_upper)
        v = rng.normal(size=n)
        controller.observe(ghc.RobotState(0.0, q, v))
        controller.step(ghc.RobotState(0.0, q, v))
        problem = controller.problem()
        order = levels_of(problem.jacobian, problem.target, problem.starts, problem.alpha)
        near = np.eye(n)[rng.choice(n, size=_ROWS[0], replace=False)]
        first = Level(near, rng.normal(size=_ROWS[0]))
        states.append(_State([first, *order[1:4]], q, v))
    assert [len(level.target) for level in states[0].order] == list(_ROWS)
    return states


def _steps(
    model: Any,
) -> dict[str, tuple[Callable[[_State], object], Callable[[_State], object]]]:
    """Law and dynamics of each: accelerations, and from there torques."""
    data = model.createData()
    damping = [_W] * len(_ROWS)
    mass = _symmetric(pin.crba(model, data, pin.neutral(model)))

    def torque_of(state: _State) -> Array:
        return pin.rnea(model, data, state.q, state.v, state.v)

    def resolved_torque(state: _State) -> Array:
        """tau = M x + h from M and h, which these laws need anyway."""
        inertia = _symmetric(pin.crba(model, data, state.q))
        bias = pin.nonLinearEffects(model, data, state.q, state.v)
        return inertia @ state.v + bias

    def with_order(law: Callable[..., Array], *given: Any) -> Callable[[_State], Array]:
        return lambda state: law(state.order, *given)

    return {
        "task_priority": (with_order(task_priority, damping, _TOLERANCE), torque_of),
        "resolved_acceleration": (
            with_order(resolved_acceleration, damping, _TOLERANCE),
            torque_of,
        ),
        "unifying": (
            lambda state: unifying(state.order, mass @ mass, damping, _TOLERANCE),
            resolved_torque,
        ),
        "operational_space": (
            with_order(operational_space, mass, damping, _TOLERANCE),
            resolved_torque,
        ),
    }


def _symmetric(upper: Array) -> Array:
    return np.triu(upper) + np.triu(upper, 1).T


def table(result: dict[str, Any]) -> str:
    """Times and operations as ratios to task_priority, beside those of the paper."""
    facts, found = result["facts"], result["formulations"]
    first = found.get(FORMULATIONS[0])
    lines = []
    for name, row in found.items():
        whole = row["law_us"] + row["dynamics_us"]
        ratios = ["-", "-", "-"]
        if first is not None:
            ratios = [
                shown(row["law_us"] / first["law_us"]),
                shown(whole / (first["law_us"] + first["dynamics_us"])),
                shown(row["operations"] / first["operations"]),
            ]
        paper = shown(PAPER_MS[name] / PAPER_MS[FORMULATIONS[0]])
        lines.append([name, shown(PAPER_MS[name]), paper, *ratios, f"{row['operations']:.0f}"])
    head = ["formulation", "paper [ms]", "paper, ratio", "NumPy, law", "NumPy, law and dynamics"]
    head += ["operations, ratio", "operations"]
    rows = " + ".join(str(count) for count in facts["rows"])
    return (
        f"{facts['joints']} joints, levels of {rows} rows, {facts['states']} random states (seed "
        f"{facts['seed']}): fastest of {_REPEATS} evaluations, median over the states, as ratios "
        "to `task_priority`. Operations: products of a step, dynamics included.\n\n"
        + markdown_table(head, lines)
    )
