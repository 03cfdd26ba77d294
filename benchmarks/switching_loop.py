"""The scenario `priority_switching` as a library loop: figures of each phase, no ROS."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import ghc_controller as ghc
from ghc_controller.hierarchy.levels import levels
from ghc_controller.types import Array
from ghc_sim_bridge import SimulationDiverged, Simulator
from ghc_sim_bridge.analysis.metrics import jerk_integral, peak_torque_rate
from ghc_sim_bridge.scenario.plan import PlannedPhase, RunOptions, RunPlan
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

SCENARIO = "priority_switching"
_CALM = 3.0  # [s] at the end of a phase over which the speed is averaged


class Timing(NamedTuple):
    """How long a run takes."""

    ramp: float | None = None  # [s] of each transition; None = as in the scenario
    hold: float | None = None  # [s] after each transition; None = as in the scenario


def make_run(timing: Timing) -> RunPlan:
    """Phases, references and parameters of the scenario with this timing."""
    scenario = load_scenario(SCENARIO)
    if timing.hold is not None:
        phases = tuple(replace(phase, hold=timing.hold) for phase in scenario.phases)
        scenario = replace(scenario, phases=phases)
    return make_plan(scenario, RunOptions(transition=timing.ramp), Path())


def run_phases(
    formulation: str, optimization: ghc.FormulationSettings, timing: Timing
) -> dict[str, Any]:
    """Figures by phase: errors of the tasks, speed, torque rate and jerk integral.

    A phase that the simulation did not reach has none; the run then says when it diverged.
    """
    plan = make_run(timing)
    controller = _controller(plan, formulation, optimization)
    simulator = Simulator(plan.scenario.scene, joint_names=controller.model.joint_names)
    _schedule(controller, simulator, plan)
    torque, velocity, acceleration = [], [], []
    errors: list[dict[str, float]] = []
    status: Counter[str] = Counter({s.name: 0 for s in ghc.StepStatus})
    qps, diverged = 0, None
    for phase in plan.phases:
        while simulator.time < phase.end - 1e-9 and diverged is None:
            result = controller.step(simulator.state())
            status[result.status.name] += 1
            qps += result.solution.qp_solved
            torque.append(result.torque.copy())
            try:
                simulator.step(result.torque)
            except SimulationDiverged:
                diverged = simulator.time
                break
            velocity.append(simulator.state().v.copy())
            acceleration.append(simulator.acceleration.copy())
        if diverged is None:
            errors.append({task.name: task.motion_error for task in controller.report().tasks})
    reached = plan.phases[: len(errors)]
    log = [np.array(rows[: len(velocity)]) for rows in (torque, velocity, acceleration)]
    return {
        "phases": [
            figures | {"errors": error, "first": error[_first_task(controller, phase)]}
            for figures, error, phase in zip(
                _figures(log, reached, plan.control_dt), errors, reached, strict=True
            )
        ],
        "status": dict(status),
        "ticks_with_qp": qps,
        "diverged_at_s": diverged,
    }


def _controller(
    plan: RunPlan, formulation: str, optimization: ghc.FormulationSettings
) -> ghc.Controller:
    parameters = plan.scenario.parameters["controller"]
    settings = ghc.Settings(
        formulation=formulation,
        control_dt=plan.control_dt,
        velocity_limit=parameters["velocity_limit"],
        torque_rate_limit=plan.scenario.torque_rate_limit,
        optimization=optimization,
    )
    return ghc.Controller.for_robot(plan.scenario.robot, settings)


def target_references(controller: ghc.Controller) -> Iterator[ghc.ReferenceTrajectory]:
    """The static targets of the scenario."""
    joints = controller.model.joint_names
    for reference in load_scenario(SCENARIO).references:
        task = controller.references.task(reference.task)
        target = np.array(reference.points[0].position)
        if reference.joints:
            target = target[[reference.joints.index(name) for name in joints]]
        yield ghc.ReferenceTrajectory.static(task, task.static_target(target))


def _schedule(controller: ghc.Controller, simulator: Simulator, plan: RunPlan) -> None:
    """Send all targets and transitions, as an experiment does before time runs."""
    controller.observe(simulator.state())
    for reference in target_references(controller):
        controller.add_reference(reference)
    for planned in plan.phases:
        text = planned.phase.hierarchy
        matrix = ghc.matrix_from_hierarchy(controller.robot.task_names, text)
        transition = ghc.Transition(matrix, planned.start, planned.ramp, hierarchy=text)
        controller.add_transition(transition, 0.0)


def _first_task(controller: ghc.Controller, planned: PlannedPhase) -> str:
    names = controller.robot.task_names
    return names[levels(ghc.matrix_from_hierarchy(names, planned.phase.hierarchy).alpha)[0][0]]


def _figures(
    log: list[Array], phases: tuple[PlannedPhase, ...], control_dt: float
) -> list[dict[str, Any]]:
    """Of each phase; rows of the log as in a FullRateLog, but the speed, which is that after."""
    torque, velocity, acceleration = log
    time: Array = control_dt * np.arange(len(torque), dtype=np.float64)
    spans = [(planned.start, planned.end) for planned in phases]
    if not spans:
        return []
    rates = peak_torque_rate(time, torque, control_dt, spans).per_phase
    jerks = jerk_integral(time, acceleration, spans).per_phase
    found = []
    for planned, rate, jerk in zip(phases, rates, jerks, strict=True):
        calm = (time >= planned.end - _CALM - 1e-9) & (time < planned.end - 1e-9)
        calm &= time >= planned.start - 1e-9
        found.append(
            {
                "hierarchy": planned.phase.hierarchy,
                "speed": float(np.abs(velocity[calm]).mean()),
                "torque_rate": rate,
                "jerk": jerk,
            }
        )
    return found
