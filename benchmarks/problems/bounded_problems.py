"""Random well-scaled problems without a robot, each with bounds that the free optimum breaks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

import ghc_controller as ghc
from benchmarks.problems.reference_cascade import Damping, hard_cascade
from benchmarks.random_tasks import strict_matrix
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Array, Bounds

SEED = 5
SIZES = (7, 17, 32)  # joints, in turn


class BoundedProblem(NamedTuple):
    """Tasks in strict order, highest first, with bounds on accelerations and torques."""

    jacobians: list[Array]  # (m_i, n)
    targets: list[Array]  # (m_i,)
    mass: Array  # (n, n)
    bias: Array  # (n,)
    acceleration: Bounds  # (n,)
    torque: Bounds  # (n,)

    def control_problem(self) -> ghc.ControlProblem:
        """As formulations take it."""
        sizes = [len(target) for target in self.targets]
        k = len(sizes)
        return ghc.ControlProblem(
            jacobian=np.ascontiguousarray(np.vstack(self.jacobians)),
            target=np.concatenate(self.targets),
            starts=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
            priorities=Priorities.of(strict_matrix(range(k), k)),
            velocity=np.zeros(len(self.bias)),
            mass_matrix=self.mass,
            bias=self.bias,
            acceleration=self.acceleration,
            torque=self.torque,
            torque_limit=self.torque,
        )

    def rows(self) -> tuple[Array, Array, Array]:
        """C, lower and upper of the finite bounds on x, as rows lower <= C x <= upper."""
        C = np.vstack([np.eye(len(self.bias)), self.mass])
        lower = np.concatenate([self.acceleration.lower, self.torque.lower - self.bias])
        upper = np.concatenate([self.acceleration.upper, self.torque.upper - self.bias])
        finite = np.isfinite(lower)
        return C[finite], lower[finite], upper[finite]

    def hard_cascade(self, w: float | Damping, bounded: bool = True) -> tuple[Array, Array] | None:
        """Reference answer and residuals, damped by w; see reference_cascade."""
        C, lower, upper = self.rows()
        if not bounded:
            C, lower, upper = C[:0], lower[:0], upper[:0]
        return hard_cascade(self.jacobians, self.targets, w, C, lower, upper)


def bounded_problems(count: int, w: float) -> Iterator[BoundedProblem]:
    """The first `count` problems; w is the damping of the free optimum that sizes the bounds.

    3 to 6 levels of 1 to 3 Gaussian rows, the last one mostly the whole posture; mass matrix
    A A^T / n + 0.1 I. Torque bounds about the bias are 0.1 to 1.5 of the largest torque of the
    free optimum, in half of the problems accelerations are bounded alike.
    """
    rng = np.random.default_rng(SEED)
    found = 0
    while found < count:
        n, k = SIZES[found % len(SIZES)], int(rng.integers(3, 7))
        jacobians, targets = [], []
        for i in range(k):
            m = n if (i == k - 1 and rng.random() < 0.6) else int(rng.integers(1, 4))
            J = np.eye(n) if m == n else rng.normal(size=(m, n)) / np.sqrt(n)
            jacobians.append(J)
            targets.append(rng.normal(size=m) * 10 ** rng.uniform(-0.5, 0.5))
        root = rng.normal(size=(n, n))
        mass, bias = root @ root.T / n + 0.1 * np.eye(n), rng.normal(size=n)
        free_answer = hard_cascade(
            jacobians, targets, w, np.zeros((0, n)), np.zeros(0), np.zeros(0)
        )
        assert free_answer is not None  # without bounds there is an answer
        free = free_answer[0]
        share = rng.uniform(0.2, 1.0)
        size = np.abs(mass @ free).max() * share * rng.uniform(0.5, 1.5, n)
        torque = Bounds(bias - size, bias + size)
        box = np.full(n, np.inf)
        if rng.random() < 0.5:
            box = np.abs(free).max() * share * rng.uniform(0.5, 1.5, n)
        problem = BoundedProblem(jacobians, targets, mass, bias, Bounds(-box, box), torque)
        C, lower, upper = problem.rows()
        if (lower <= C @ free).all() and (C @ free <= upper).all():
            continue  # no bound is active
        found += 1
        yield problem
