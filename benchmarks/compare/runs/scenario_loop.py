"""A scenario of the stack as a loop through the library."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import ghc_controller as ghc
from benchmarks.compare.case import Result
from benchmarks.compare.method import Method
from benchmarks.compare.runs.closed_loop import Loop, Span, run_loop
from benchmarks.compare.runs.measures import measure
from benchmarks.compare.runs.planned import LIMITS, planned_robot, planned_transition
from benchmarks.fencing_loop import start
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.scenario.fields import Scenario
from ghc_sim_bridge.scenario.plan import PlannedPhase, RunOptions, RunPlan
from ghc_sim_bridge.scenario.planning import make_plan
from ghc_sim_bridge.scenario.scenario import load_scenario

_QUICK_RAMP, _QUICK_HOLD = 0.02, 0.02  # [s]
_FALLEN = 0.6  # [-] height of the base, of that at the start, below which a robot has fallen


def plan_of(scenario: Scenario, method: Method, quick: bool) -> RunPlan:
    """Times and parameters of the scenario for a method; `hqp` switches at once."""
    options = RunOptions(formulation=method.formulation)
    if quick:
        phases = tuple(replace(phase, hold=_QUICK_HOLD) for phase in scenario.phases)
        scenario = replace(
            scenario, phases=phases, transition=min(scenario.transition, _QUICK_RAMP)
        )
    return make_plan(scenario, options, Path())


def run_scenario(
    method: Method,
    quick: bool,
    name: str,
    variant: str = "",
    hold: float | None = None,
    control_dt: float | None = None,
    held: int = 0,
    last_quarter: bool = False,
) -> Result:
    """Run a scenario with its targets and orders, torque rate limit off.

    Args:
        hold: [s] after each transition, as in the scenario when not given.
        control_dt: [s] likewise.
        held: accelerations that the contacts of the robot keep at rest.
        last_quarter: errors at the end are means of the last quarter.
    """
    scenario = load_scenario(name, variant)
    if hold is not None:
        phases = tuple(replace(phase, hold=hold) for phase in scenario.phases)
        scenario = replace(scenario, phases=phases)
    scenario = replace(scenario, control_dt=control_dt or scenario.control_dt)
    plan = plan_of(scenario, method, quick)
    controller = _controller(plan, method)
    simulator = Simulator(
        scenario.scene,
        plan.control_dt,
        plan.parameters["sim_bridge"]["physics_dt"],
        controller.model.joint_names,
    )
    start(controller, simulator, plan.scenario)
    spans = tuple(_schedule(controller, planned) for planned in plan.phases)
    floating = controller.model.floating_base
    lowest = _FALLEN * simulator.state().q[2] if floating else 0.0
    loop = Loop(controller, simulator, spans, held=held, lowest=lowest)
    return measure(loop, run_loop(loop), last_quarter)


def _controller(plan: RunPlan, method: Method) -> ghc.Controller:
    given = plan.parameters["controller"]
    damping = given.get("velocity_damping", ghc.FormulationSettings().velocity_damping)
    settings = ghc.Settings(
        formulation=method.formulation,
        control_dt=plan.control_dt,
        hierarchy=given.get("hierarchy", ""),
        torque_rate_limit=0.0,
        optimization=method.settings(velocity_damping=damping),
        **{name: given[name] for name in LIMITS if name in given},
    )
    return ghc.Controller(planned_robot(plan), settings)


def _schedule(controller: ghc.Controller, planned: PlannedPhase) -> Span:
    """Send the transition of a phase; GhcError where the formulation rejects it."""
    transition = planned_transition(planned, controller.robot.task_names)
    controller.add_transition(transition, 0.0)
    alpha = transition.target.alpha
    return Span(planned.phase.hierarchy, alpha, planned.start, planned.end)
