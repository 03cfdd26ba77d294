"""iCub standing on both feet: small and large shifts of the center of mass."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.icub_states import SCENE, icub_controller
from benchmarks.study_results import shown
from ghc_sim_bridge import SimulationDiverged, Simulator
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "standing"
TITLE = "iCub standing, center of mass moved"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp")
_TASK = "center_of_mass"
_SHIFTS = {  # [m] x forward, y to the left, z up
    "2 cm": (0.02, 0.02, 0.01),
    "8 cm sideways": (0.0, 0.08, 0.0),
    "7 cm forward": (0.07, 0.0, 0.0),
    "8 cm forward": (0.08, 0.0, 0.0),  # 2 mm beyond the soles, which end 0.1065 m ahead
}
_QUICK_SHIFTS = {"2 cm": (0.02, 0.02, 0.01)}
_BEFORE, _AFTER = 500, 6000  # [ms] at rest, and after the step of the target
_QUICK = (2, 8)  # [ms]
_GOALS = {"error_m": 1e-4, "without_qp": 0.98}  # at most; at least
_FALLEN = 0.6  # [-] height of the base, of that at the start, below which a run ends


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """One closed loop per formulation and shift, 1 ms, from the start of the scene."""
    before, after = _QUICK if quick else (_BEFORE, _AFTER)
    shifts = _QUICK_SHIFTS if quick else _SHIFTS
    found = {
        name: {title: _loop(name, shift, before, after) for title, shift in shifts.items()}
        for name in formulations
    }
    facts = {"before_ms": before, "after_ms": after, "shifts_m": shifts}
    return {"facts": facts, "formulations": found}


def _loop(
    formulation: str, shift: tuple[float, float, float], before: int, after: int
) -> dict[str, Any]:
    controller = icub_controller(formulation)
    simulator = Simulator(SCENE, joint_names=controller.model.joint_names)
    start = simulator.state()
    controller.observe(start)
    status: Counter[str] = Counter({s.name: 0 for s in ghc.StepStatus})
    ticks, without_qp, fell = 0, 0, None
    steps: list[float] = []
    previous = None
    for tick in range(before + after):
        state = simulator.state()
        if tick == before:
            task = controller.references.task(_TASK)
            goal = np.array(task.current(controller.model)) + np.array(shift)
            reference = ghc.ReferenceTrajectory.static(task, task.static_target(goal), state.time)
            controller.add_reference(reference)
        result = controller.step(state)
        ticks += 1
        status[result.status.name] += 1
        without_qp += not result.solution.qp_solved
        torque = result.torque.copy()
        if previous is not None and tick != before:
            steps.append(float(np.abs(torque - previous).max()))
        previous = torque
        try:
            simulator.step(torque)
        except SimulationDiverged:
            fell = state.time
            break
        if simulator.state().q[2] < _FALLEN * start.q[2]:
            fell = simulator.time
            break
    errors = {task.name: task.motion_error for task in controller.report().tasks}
    return {
        "error_m": errors[_TASK],
        "without_qp": without_qp / ticks,
        "status": dict(status),
        "height_m": [start.q[2], simulator.state().q[2]],
        "largest_torque_step_nm": max(steps),
        "fell_at_s": fell,
    }


def table(result: dict[str, Any]) -> str:
    """One line per formulation and shift."""
    lines = []
    for name, shifts in result["formulations"].items():
        for title, row in shifts.items():
            first, last = row["height_m"]
            lines.append(
                [
                    *(name, title, shown(row["error_m"], ".1e")),
                    f"{100.0 * row['without_qp']:.1f}",
                    *(str(row["status"][status.name]) for status in ghc.StepStatus),
                    f"{first:.3f} / {last:.3f}",
                    "-" if row["fell_at_s"] is None else f"{row['fell_at_s']:.2f}",
                    shown(row["largest_torque_step_nm"]),
                ]
            )
    head = ["formulation", "shift", "error at the end [m]", "ticks without a QP [%]"]
    head += [status.name for status in ghc.StepStatus]
    head += ["base height before / after [m]", "fell at [s]", "largest torque step [Nm per ms]"]
    facts = result["facts"]
    shifts = "; ".join(
        f"{title}: {', '.join(f'{part:g}' for part in shift)} m"
        for title, shift in facts["shifts_m"].items()
    )
    return (
        f"Target of the center of mass moved at once after {1e-3 * facts['before_ms']:g} s at "
        f"rest (x, y, z: {shifts}), then {1e-3 * facts['after_ms']:g} s at 1 ms; torque rate "
        "limit off, order of the robot. A run ends with a fall. The torque step at the switch of "
        "the target itself is left out. Goals of the default: 2 cm reached to "
        f"{_GOALS['error_m']:g} m with at least {100.0 * _GOALS['without_qp']:g} % of the ticks "
        "without a QP; 8 cm: stands, every tick SOLVED. The center of mass starts 0.028 m ahead "
        "of the ankles and the soles end at 0.1065 m: 8 cm forward lies 2 mm beyond them, where "
        "no center of mass can stay; no formulation looks ahead.\n\n" + markdown_table(head, lines)
    )
