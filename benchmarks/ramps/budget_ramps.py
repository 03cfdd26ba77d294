"""Torque-rate budgets: rate added by a ramp, and the shortest ramp within a budget."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

import ghc_controller as ghc
from benchmarks.random_tasks import strict_matrix
from ghc_controller.formulations import ForceExpansion, make_formulation
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator

PERIOD = 1e-3  # [s]
_LONGEST = 8.0  # [s] a ramp that takes longer counts as stalled
_HALVINGS = 7  # of the bracket of the shortest duration


@dataclass(frozen=True, slots=True)
class Case:
    """One change of priorities of one robot."""

    q: Array  # (nq,) at the start
    references: Sequence[ghc.ReferenceTrajectory]
    begin: Sequence[int]  # orders of task indices, highest first
    goal: Sequence[int]
    scene: str  # of the simulator; "" = the state is held
    lead: float  # [s] of motion before the change


@dataclass(frozen=True, slots=True)
class Way:
    """Result of one ramp."""

    duration: float  # [s]; inf: not done within _LONGEST
    added: float  # [Nm/s @ 1 ms] largest change of torque by the ramp alone


def follow(controller: ghc.Controller, case: Case, duration: float, torque_rate: float) -> Way:
    """Ramp linearly over `duration` [s], or with a budget `torque_rate` [Nm/s]."""
    step = begin_case(controller, case)
    names = controller.robot.task_names
    start, schedule = round(case.lead / PERIOD) * PERIOD, controller.priorities
    target = ghc.PriorityMatrix(names, strict_matrix(case.goal, len(names)))
    controller.add_transition(
        ghc.Transition(target, start, duration, ghc.Profile.LINEAR, torque_rate=torque_rate), 0.0
    )
    judge = make_formulation(controller.formulation.name, controller.settings.optimization)
    costs: dict[bytes, ForceExpansion] = {}  # on contact forces, of orders seen so far
    added, tick = 0.0, 0
    while tick * PERIOD < start + _LONGEST:
        before = schedule.in_force
        step(tick * PERIOD)
        if tick * PERIOD >= start - 0.5 * PERIOD:
            problem = _with_costs(controller.problem(), costs)
            change = _by_shares(judge, problem, before, schedule.in_force)
            added = max(added, float(np.abs(change).max()) / PERIOD)
            if not schedule.in_transition:
                return Way((tick + 1) * PERIOD - start, added)
        tick += 1
    return Way(np.inf, added)


def _with_costs(
    problem: ghc.ControlProblem, costs: dict[bytes, ForceExpansion]
) -> ghc.ControlProblem:
    """The problem with the costs on forces of orders that have left the mixture."""
    contacts = problem.contacts
    if contacts is None:
        return problem
    costs |= contacts.of_candidates
    return replace(problem, contacts=contacts._replace(of_candidates=dict(costs)))


def _by_shares(
    judge: ghc.Formulation, problem: ghc.ControlProblem, before: Priorities, now: Priorities
) -> Array:
    """Change of torque (a,) [Nm] by the shares alone: every order is solved once.

    The difference of two blends would hold that of two active sets as well: with ten tasks at
    their bounds what the solver remembers moves the answer by up to 0.07 Nm, whatever the shares.
    """
    shares: dict[bytes, float] = {}
    orders: dict[bytes, Array] = {}
    for priorities, sign in ((now, 1.0), (before, -1.0)):
        for candidate in priorities.candidates:
            key = candidate.alpha.tobytes()
            orders[key] = candidate.alpha
            shares[key] = shares.get(key, 0.0) + sign * candidate.share
    change = np.zeros(len(problem.torque.lower))
    for key, share in shares.items():
        if share:
            alone = replace(problem, priorities=Priorities.of(orders[key]))
            change += share * judge.solve(alone).torque
    return change


def shortest(controller: ghc.Controller, case: Case, budget: float, about: float) -> float:
    """Shortest duration [s] of a linear ramp that adds at most `budget`, by bisection.

    Args:
        about: [s] a duration to look around.
    """
    low, high = 0.0, about
    while follow(controller, case, high, 0.0).added > budget * (1.0 + 1e-6):
        low, high = high, 1.5 * high
        if high > _LONGEST:
            return np.inf
    low = max(low, 0.25 * high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if follow(controller, case, middle, 0.0).added > budget * (1.0 + 1e-6):
            low = middle
        else:
            high = middle
    return np.ceil(high / PERIOD - 1e-9) * PERIOD


def whole_change(controller: ghc.Controller, case: Case) -> float:
    """[Nm] difference of the solutions of both orders at the start of the ramp."""
    step = begin_case(controller, case)
    for tick in range(round(case.lead / PERIOD) + 1):
        step(tick * PERIOD)
    problem, k = controller.problem(), len(controller.robot.task_names)
    judge = make_formulation(controller.formulation.name, controller.settings.optimization)
    answers = [
        judge.solve(replace(problem, priorities=Priorities.of(strict_matrix(order, k)))).torque
        for order in (case.begin, case.goal)
    ]
    return float(np.abs(answers[1] - answers[0]).max())


def begin_case(controller: ghc.Controller, case: Case) -> Callable[[float], Array]:
    """Initialize the controller for a case; returns a function that executes one step."""
    names, model = controller.robot.task_names, controller.model
    controller.reset()
    controller.observe(ghc.RobotState(0.0, case.q, np.zeros(model.nv)))
    for reference in case.references:
        controller.add_reference(reference)
    matrix = ghc.PriorityMatrix(names, strict_matrix(case.begin, len(names)))
    controller.add_transition(ghc.Transition(matrix, 0.0, 0.0), 0.0)
    if not case.scene:
        still = np.zeros(model.nv)
        return lambda time: controller.step(ghc.RobotState(time, case.q, still)).torque
    simulator = Simulator(case.scene, joint_names=model.joint_names)
    simulator.reset(case.q)

    def step(_: float) -> Array:
        torque = controller.step(simulator.state()).torque
        simulator.step(torque)
        return torque

    return step
