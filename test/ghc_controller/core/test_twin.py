"""Ticks of the core without an active bound against the dense twin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha
from reference.smooth_twin import twin_answer

from ghc_controller.formulations import ControlProblem, SolutionStatus, make_formulation
from ghc_controller.hierarchy.priorities import Candidate, Priorities
from ghc_controller.types import Array, Bounds


def _open(problem: ControlProblem) -> ControlProblem:
    """The same problem without any bound."""

    def unbounded(size: int) -> Bounds:
        return Bounds(np.full(size, -np.inf), np.full(size, np.inf))

    n, a = len(problem.bias), len(problem.bias) - problem.unactuated
    contacts = problem.contacts
    if contacts is not None:
        forces = unbounded(len(contacts.force_lower))
        contacts = contacts._replace(force_lower=forces.lower, force_upper=forces.upper)
    joints = unbounded(a)
    return replace(
        problem, acceleration=unbounded(n), torque=joints, torque_limit=joints, contacts=contacts
    )


def _apart(found: Array, wanted: Array) -> float:
    return float(np.abs(found - wanted).max(initial=0.0) / (1.0 + np.abs(wanted).max(initial=0.0)))


@pytest.mark.parametrize("kind", ["fixed", "standing", "dependent", "few", "flight"])
def test_a_tick_is_that_of_the_twin(kind: str) -> None:
    """Accelerations, forces and torques to 1e-10; ramps of three orders as well. Seed 8.

    Contacts with a row that depends on others, too few contacts to carry the base, and none.
    """
    rng = np.random.default_rng(8)
    places = ([0, 1, 2], [2, 1, 0], [1, 0, 2])
    orders = [strict_alpha(3)[np.ix_(place, place)] for place in places]
    count = {"fixed": 0, "few": 1}.get(kind, 4)
    for trial in range(6):
        problem = random_problem(rng, 22, [3, 2, 6], strict_alpha(3), contacts=count)
        problem = replace(_open(problem), velocity=rng.normal(size=22))
        contacts = problem.contacts
        if kind == "dependent" and contacts is not None:
            rows = contacts.jacobian.copy()
            rows[-1] = rows[0] - rows[1]
            drift = np.append(contacts.drift_target[:-1], contacts.drift_target[:2] @ [1.0, -1.0])
            problem = replace(
                problem, contacts=contacts._replace(jacobian=rows, drift_target=drift)
            )
        if kind == "flight":
            problem = replace(problem, contacts=None)
        shares = (1.0,) if trial < 3 else (0.2, 0.5, 0.3)
        mixture = [Candidate(orders[i], share) for i, share in enumerate(shares)]
        problem = replace(problem, priorities=Priorities.mixed(mixture))
        found = make_formulation("cascade").solve(problem)
        assert found.status is SolutionStatus.SOLVED
        assert not found.qp_solved
        for value, wanted in zip(
            (found.acceleration, found.force, found.torque), twin_answer(problem), strict=True
        ):
            assert _apart(value, wanted) < 1e-10
