"""Ticks of the core without an active bound against the dense twin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import own_costs, random_problem, strict_alpha
from reference.smooth_twin import apart, twin_answer, unbounded

from ghc_controller.formulations import SolutionStatus, make_formulation
from ghc_controller.hierarchy.priorities import Candidate, Priorities


@pytest.mark.parametrize("kind", ["fixed", "standing", "dependent", "few", "flight"])
def test_a_tick_is_that_of_the_twin(kind: str) -> None:
    """Accelerations, forces and torques to 1e-10; ramps of three orders as well. Seed 8.

    Contacts with a row that depends on others, too few contacts to carry the base, and none. Some
    of the ramps have a cost on forces for each order.
    """
    rng = np.random.default_rng(8)
    places = ([0, 1, 2], [2, 1, 0], [1, 0, 2])
    orders = [strict_alpha(3)[np.ix_(place, place)] for place in places]
    count = {"fixed": 0, "few": 1}.get(kind, 4)
    for trial in range(6):
        problem = random_problem(rng, 22, [3, 2, 6], strict_alpha(3), contacts=count)
        problem = replace(unbounded(problem), velocity=rng.normal(size=22))
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
        if trial == 5:
            problem = own_costs(rng, problem)
        found = make_formulation("cascade").solve(problem)
        assert found.status is SolutionStatus.SOLVED
        assert not found.qp_solved
        for value, wanted in zip(
            (found.acceleration, found.force, found.torque), twin_answer(problem), strict=True
        ):
            assert apart(value, wanted) < 1e-10


@pytest.mark.parametrize("size", [1.0, 1e3, 1e6])
def test_levels_without_a_direction_left_are_those_of_the_twin(size: float) -> None:
    """Seven joints, spent by the first three levels; goals of any size to 1e-10. Seed 9.

    The core answers the last levels at once where they cannot move by 1e-9 rad/s^2.
    """
    rng = np.random.default_rng(9)
    sizes = [3, 3, 3, 3, 7]
    for _ in range(20):
        problem = unbounded(random_problem(rng, 7, sizes, strict_alpha(5)))
        target = problem.target.copy()
        target[sum(sizes[:3]) :] *= size
        problem = replace(problem, velocity=rng.normal(size=7), target=target)
        found = make_formulation("cascade").solve(problem)
        for value, wanted in zip(
            (found.acceleration, found.torque), twin_answer(problem)[::2], strict=True
        ):
            assert apart(value, wanted) < 1e-10
