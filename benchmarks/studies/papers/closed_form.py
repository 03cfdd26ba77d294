"""GHC in closed form (section 4.1 of the paper): what each projector protects, and torque laws."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.problems.closed_form_laws import PROJECTORS, ClosedForm
from benchmarks.study_results import shown
from benchmarks.switching_loop import Timing, make_run, target_references
from ghc_controller.formulations import Metric, make_formulation
from ghc_controller.types import Array
from ghc_sim_bridge import SimulationDiverged, Simulator
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "closed_form"
TITLE = "Closed-form GHC: projectors and torque laws"
FORMULATIONS = ("ghc",)
FIGURE = "closed_form.png"
CAPTION = (
    "Left: how much of the first task a third one still moves, while the second one comes between "
    "them (alpha 0 to 1; median of random tasks; lines at the bottom are rounding). Right: KUKA, "
    "error of the first task of each order at the end of a phase"
)
SEED = 9
_PROBLEMS, _QUICK = 200, 5
_JOINTS, _ROWS = 10, (3, 3, 3)
_SHARES = np.linspace(0.0, 1.0, 11)
_SMALLEST = 1e-16
_PERIOD = 4e-3  # [s]
_SHIFTS = (1e-14, 1e-13, 1e-12, -1e-12)  # [-] of the first torque, of a law that diverges
_SETTINGS = ghc.FormulationSettings(velocity_damping=0.0)

_LAWS: dict[str, Callable[[], ghc.Formulation]] = {
    **{
        f"acceleration, P of {name}": lambda projector=projector: ClosedForm(  # type: ignore[misc]
            projector, _SETTINGS
        )
        for name, projector in PROJECTORS.items()
    },
    "torque, static": lambda: ClosedForm(PROJECTORS["(11), generalized"], _SETTINGS, static=True),
    "torque, dynamic = ghc, metric torque": lambda: _ghc(Metric.TORQUE),
    "operational = ghc, metric inertia": lambda: _ghc(Metric.INERTIA),
    "ghc": lambda: _ghc(Metric.ACCELERATION),
}


def _ghc(metric: Metric) -> ghc.Formulation:
    return make_formulation("ghc", ghc.FormulationSettings(velocity_damping=0.0, metric=metric))


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Projectors on random rows, then the laws in closed loop."""
    count = _QUICK if quick else _PROBLEMS
    timing = Timing(ramp=0.02, hold=0.02) if quick else Timing()
    found = {
        "projectors": {name: _protection(project, count) for name, project in PROJECTORS.items()},
        "laws": {name: _spread(make, timing) for name, make in _LAWS.items()},
    }
    facts = {"problems": count, "seed": SEED, "joints": _JOINTS, "rows": _ROWS, "quick": quick}
    return {"facts": facts, "formulations": dict.fromkeys(formulations, found)}


def _protection(project: Callable[..., Array], count: int) -> dict[str, Any]:
    """|J_j P_3| in the spectral norm over that of J_j, as task 2 comes between 1 and 3."""
    rng = np.random.default_rng(SEED)
    first, second, low, high = [], [], np.inf, -np.inf
    for _ in range(count):
        rows = [rng.normal(size=(m, _JOINTS)) for m in _ROWS]
        path = []
        for share in _SHARES:
            projector = project(rows, np.array([1.0, share, 0.0]))
            path.append(_left_of(rows[0], projector))
            values = np.linalg.svd(projector, compute_uv=False)
            high = max(high, float(values[0]))
            symmetric = np.linalg.eigvalsh(0.5 * (projector + projector.T))
            low = min(low, float(symmetric[0]))
        first.append(path)
        second.append(_left_of(rows[1], projector))
    path = np.median(first, axis=0)
    return {
        "first_path": np.maximum(path, _SMALLEST).tolist(),
        "first_worst": float(np.max(first)),
        "second_strict": float(np.max(second)),
        "smallest_eigenvalue": low,
        "largest_gain": high,
    }


def _left_of(jacobian: Array, projector: Array) -> float:
    return float(np.linalg.norm(jacobian @ projector, 2) / np.linalg.norm(jacobian, 2))


def _spread(make: Callable[[], ghc.Formulation], timing: Timing) -> dict[str, Any]:
    """A run, and for a law that diverges the times of runs whose first torque differs by rounding.

    None of these times says more than the others: the law is unstable from its first conflict on.
    """
    row = _closed_loop(make(), timing)
    if row["diverged"] is not None:
        others = [_closed_loop(make(), timing, shift)["diverged"] for shift in _SHIFTS]
        row["diverged_too"] = others
    return row


def _closed_loop(law: ghc.Formulation, timing: Timing, shift: float = 0.0) -> dict[str, Any]:
    """priority_switching without bounds: first task, calm and torque steps of each phase.

    `shift`: relative change of the first torque.
    """
    plan = make_run(timing)
    settings = ghc.Settings(
        formulation="ghc",
        control_dt=_PERIOD,
        torque_rate_limit=0.0,
        position_limits=False,
        velocity_limits=False,
        optimization=_SETTINGS,
    )
    controller = ghc.Controller.for_robot(plan.scenario.robot, settings)
    controller.formulation = law
    simulator = Simulator(
        plan.scenario.scene, _PERIOD, _PERIOD, joint_names=controller.model.joint_names
    )
    controller.observe(simulator.state())
    for reference in target_references(controller):
        controller.add_reference(reference)
    names = controller.robot.task_names
    for phase in plan.phases:
        text = phase.phase.hierarchy
        matrix = ghc.matrix_from_hierarchy(names, text)
        controller.add_transition(
            ghc.Transition(matrix, phase.start, phase.ramp, hierarchy=text), 0.0
        )
    first: list[float] = []
    step, gated, last = 0.0, 0, None
    for phase in plan.phases:
        while simulator.time < phase.end - 1e-9:
            result = controller.step(simulator.state())
            gated += bool(result.gate_hits)
            if last is not None and first:
                step = max(step, float(np.abs(result.torque - last).max()))
            last = result.torque.copy()
            try:
                simulator.step((1.0 + shift) * result.torque)
            except SimulationDiverged:
                return _row(first, step, gated, simulator.time)
            shift = 0.0
        errors = {task.name: task.motion_error for task in controller.report().tasks}
        first.append(errors[phase.phase.hierarchy.split(" > ")[0]])
    return _row(first, step, gated, None)


def _row(first: list[float], step: float, gated: int, diverged: float | None) -> dict[str, Any]:
    return {"first": first, "torque_step": step, "gated": gated, "diverged": diverged}


def table(result: dict[str, Any]) -> str:
    """Projectors, then laws."""
    facts = result["facts"]
    parts = [
        f"{facts['problems']} random triples of tasks (seed {facts['seed']}), {facts['joints']} "
        "joints, rows " + " + ".join(map(str, facts["rows"])) + ": P_3 with alpha_31 = 1 while "
        "alpha_32 goes from 0 to 1. Left of task j: largest gain of J_j P_3 over that of J_j, "
        "worst case; 0 = task 3 cannot disturb it. An orthogonal projector has eigenvalues in "
        "[0, 1] and a gain of at most 1."
    ]
    for name, found in result["formulations"].items():
        head = ["projector", "formulation", "left of task 1", "left of task 2 at alpha_32 = 1"]
        head += ["smallest eigenvalue (symmetric part)", "largest gain"]
        lines = [
            [title, name, *(shown(row[key], ".1e") for key in _KEYS[:2])]
            + [shown(row[key]) for key in _KEYS[2:]]
            for title, row in found["projectors"].items()
        ]
        parts.append(markdown_table(head, lines))
        parts.append(
            "KUKA, `priority_switching` in closed loop at 4 ms without bounds "
            "(`velocity_damping` 0, w = 0.01): error of the first task of each order at the end "
            "of its phase [m, rad], largest torque step after the first phase, and ticks in which "
            "the gate had to keep the torque limits. Static and dynamic: torques "
            "sum P_i J_i^T f_i with P_i on rows J, and sum P_i (J_i M^-1)^+ b_i with P_i on rows "
            "J M^-1. A law that diverges is run again with its first torque changed by 1e-14 to "
            "1e-12 of itself: where the times differ they tell only that the law is unstable, and "
            "the run shown is one of many. Law (8), with the first acceleration changed by 0 to "
            "1e-12 of itself, diverged at 9.0, 30.7, 31.8 and 30.7 s, and once not at all:"
        )
        phases = max(len(row["first"]) for row in found["laws"].values())
        head = ["law", *(f"phase {k + 1}" for k in range(phases))]
        head += ["torque step [Nm per 4 ms]", "gated ticks", "diverged at [s]"]
        lines = []
        for title, row in found["laws"].items():
            errors = row["first"] + [None] * (phases - len(row["first"]))
            cells = [shown(error, ".1e") for error in errors]
            cells += [shown(row["torque_step"]), str(row["gated"]), _divergence(row)]
            lines.append([title, *cells])
        parts.append(markdown_table(head, lines))
    return "\n\n".join(parts)


def _divergence(row: dict[str, Any]) -> str:
    """Time of the run, and the range of those that differ from it by rounding."""
    if "diverged_too" not in row:
        return shown(row["diverged"])
    times = [row["diverged"], *(time for time in row["diverged_too"] if time is not None)]
    never = " or never" if None in row["diverged_too"] else ""
    return f"{shown(times[0])} ({shown(min(times))} to {shown(max(times))}{never})"


_KEYS = ("first_worst", "second_strict", "smallest_eigenvalue", "largest_gain")


def plot(result: dict[str, Any], path: Path) -> None:
    """Protection of the first task along a ramp; first tasks of the phases."""
    (found,) = result["formulations"].values()
    figure = new_figure(11.0, 3.6)
    with styled():
        left, right = figure.subplots(1, 2)
        for index, (name, row) in enumerate(found["projectors"].items()):
            left.semilogy(_SHARES, row["first_path"], color=colour(index), label=name)
        left.set_xlabel("alpha of task 2 over task 3")
        left.set_ylabel("gain of J_1 P_3 over J_1")
        left.legend(loc="center")
        for index, (name, row) in enumerate(found["laws"].items()):
            phases = np.arange(1, len(row["first"]) + 1)
            width = 4.0 - 0.45 * index  # laws that are one law lie on top of each other
            label = name if row["diverged"] is None else f"{name} (diverges)"
            style = {"color": colour(index), "lw": width, "label": label}
            right.semilogy(phases, row["first"], "o-", ms=width + 1.5, **style)
        right.set_xticks(range(1, 6))
        right.set_xlabel("phase")
        right.set_ylabel("first task [m, rad]")
        figure.legend(*right.get_legend_handles_labels(), loc="outside right center", fontsize=7)
    save_png(figure, path)
