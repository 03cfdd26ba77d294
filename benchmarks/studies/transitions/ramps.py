"""iCub in random postures: torque steps while priorities change within 0.3 s."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.icub_states import icub_controller
from benchmarks.random_tasks import Reach, random_matrix, random_references
from benchmarks.study_results import shown, shown_spread, spread
from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy import format_hierarchy
from ghc_controller.types import Array
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "ramps"
TITLE = "iCub in random postures, priority changes in 0.3 s"
FORMULATIONS = ("cascade", "balanced", "ghc")
_SEED = 0
_RAMPS, _QUICK = 40, 1
_STEPS = 303  # of 1 ms: the ramp and two more
_DURATION = 0.3  # [s]
_REACH = Reach(angle=0.5, pose=0.2)
_LARGE = 3.0  # [Nm per ms] a step above it is traced
_TRACES = 12  # ramps whose largest step is kept


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """The robot stands still; only the priorities change."""
    count, steps = (_QUICK, 40) if quick else (_RAMPS, _STEPS)
    facts = {"ramps": count, "steps": steps, "duration_s": _DURATION, "seed": _SEED}
    found = {name: _of_formulation(name, count, steps) for name in formulations}
    return {"facts": facts, "formulations": found}


def _of_formulation(formulation: str, count: int, steps: int) -> dict[str, Any]:
    controller = icub_controller(formulation)
    rng = np.random.default_rng(_SEED)
    largest: list[float] = []
    traces: list[dict[str, Any]] = []
    status: Counter[str] = Counter({s.name: 0 for s in ghc.StepStatus})
    refused = 0
    for number in range(count):
        q = _begin(controller, rng)
        (start, before), (goal, after) = (_random_priorities(controller, rng) for _ in range(2))
        try:
            controller.add_transition(ghc.Transition(start, 0.0, 0.0), 0.0)
            controller.step(ghc.RobotState(0.0, q, np.zeros(controller.model.nv)))
            controller.add_transition(ghc.Transition(goal, 1e-3, _DURATION), 0.0)
        except InvalidValue:  # eq. 13b would lose its solution
            refused += 1
            continue
        ways = {"from": before, "to": after}
        steps_nm, large, seen = _ramp(controller, q, steps)
        largest.append(max(steps_nm, default=0.0))
        traces += [{"ramp": number, **trace, **ways} for trace in large]
        status.update(seen)
    by_size = sorted(traces, key=lambda trace: trace["step_nm"])
    of_ramp = {trace["ramp"]: trace for trace in by_size}  # the largest comes last
    worst = sorted(of_ramp.values(), key=lambda trace: -trace["step_nm"])
    return {
        "largest_step_nm": spread(largest),
        "status": dict(status),
        "refused": refused,
        "large_steps": len(traces),
        "large_steps_by_cause": dict(Counter(trace["cause"] for trace in traces)),
        "ramps_with_large_steps": len({trace["ramp"] for trace in traces}),
        "traces": worst[:_TRACES],
    }


def _begin(controller: ghc.Controller, rng: np.random.Generator) -> Array:
    """(nq,) random posture, with random targets given to the controller."""
    model = controller.model
    controller.reset()
    lower, upper = np.maximum(model.position_lower, -1.2), np.minimum(model.position_upper, 1.2)
    q = np.zeros(model.nq)
    q[6] = 1.0
    q[7:] = rng.uniform(0.6 * lower, 0.6 * upper)
    controller.observe(ghc.RobotState(0.0, q, np.zeros(model.nv)))
    for reference in random_references(controller.robot, rng, _REACH):
        controller.add_reference(reference)
    return q


def _random_priorities(
    controller: ghc.Controller, rng: np.random.Generator
) -> tuple[ghc.PriorityMatrix, str]:
    """A matrix, and its hierarchy string or its kind."""
    names = controller.robot.task_names
    alpha, kind = random_matrix(rng, len(names))
    matrix = ghc.PriorityMatrix(names, alpha)
    return matrix, format_hierarchy(matrix) or kind


def _ramp(
    controller: ghc.Controller, q: Array, steps: int
) -> tuple[list[float], list[dict[str, Any]], Counter[str]]:
    """Steps between SOLVED answers [Nm], traces of the large ones, and all statuses."""
    sizes: list[float] = []
    traces: list[dict[str, Any]] = []
    status: Counter[str] = Counter()
    still = np.zeros(controller.model.nv)
    before: tuple[Array, frozenset[str], ghc.StepStatus] | None = None
    for tick in range(steps):
        result = controller.step(ghc.RobotState(1e-3 * (tick + 1), q, still))
        status[result.status.name] += 1
        active = frozenset(controller.report().active_constraints)
        if before is not None:
            change = np.abs(result.torque - before[0])
            solved = ghc.StepStatus.SOLVED is result.status is before[2]
            if solved:
                sizes.append(float(change.max()))
            if change.max() > _LARGE:
                trace = {
                    "time_s": result.time,
                    "joint": controller.model.joint_names[int(change.argmax())],
                    "step_nm": float(change.max()),
                    "status": f"{before[2].name} to {result.status.name}",
                }
                traces.append({**trace, "cause": _cause(solved, active != before[1])})
        before = result.torque.copy(), active, result.status
    return sizes, traces, status


def _cause(solved: bool, bounds_changed: bool) -> str:
    if not solved:
        return "not SOLVED before or after"
    if bounds_changed:
        return "the set of active bounds changed"
    return "the same bounds active: the formulation"  # the state, and so J, is held


def table(result: dict[str, Any]) -> str:
    """Steps by formulation, and the largest ones with what happened."""
    facts, lines, largest = result["facts"], [], []
    for name, row in result["formulations"].items():
        unsolved = [str(row["status"][key]) for key in ("RELAXED", "FALLBACK")]
        counts = [str(row[key]) for key in ("large_steps", "ramps_with_large_steps", "refused")]
        causes = "; ".join(f"{k}: {v}" for k, v in row["large_steps_by_cause"].items())
        lines.append([name, shown_spread(row["largest_step_nm"]), *unsolved, *counts, causes])
        for trace in row["traces"]:
            place = [str(trace["ramp"]), shown(trace["time_s"]), trace["joint"]]
            what = [trace["status"], trace["cause"], trace["from"], trace["to"]]
            largest.append([name, *place, shown(trace["step_nm"]), *what])
    head = ["formulation", "largest step of a ramp, median / p95 / max [Nm per ms]"]
    head += ["RELAXED ticks", "FALLBACK ticks", f"steps above {_LARGE:g}", "in ramps", "refused"]
    traced = ["formulation", "ramp", "time [s]", "joint", "step [Nm per ms]", "status", "cause"]
    return (
        f"{facts['ramps']} ramps (seed {facts['seed']}) at rest in random postures, random "
        "targets; strict orders of some tasks, orders with a cycle and arbitrary values, both "
        "before and after. The state is held, so that every step of the torque comes from the "
        "change of priorities. Steps next to a tick that is not SOLVED are traced, and not "
        "counted in the first column.\n\n"
        + markdown_table([*head, "large steps by cause"], lines)
        + f"\n\nThe largest step of the ramps with steps above {_LARGE:g} Nm per ms (the worst "
        f"{_TRACES} ramps of each formulation):\n\n"
        + markdown_table([*traced, "from", "to"], largest)
    )
