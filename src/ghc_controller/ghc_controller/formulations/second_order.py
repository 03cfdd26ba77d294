"""Second-order terms of tasks at torque level: (x + kd v)^T S (x + kd v) beside |J x - b|^2.

The control law requires J x = kp e - kd J v - dJ/dt v. Applied to the curvature as well,
    (J^T J + S) (x + kd v) = kp J^T e,
it is the Newton step of gn_qn_2018 as a second-order system: where a target is out of reach S > 0
takes the place of the direction that J loses, and the arm comes to rest there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.problem.second_order_terms import SecondOrder
from ghc_controller.types import Array

_MULTIPLIER_DAMPING = 1e-4  # [-] rows above that are nearly singular must not blow up


class LevelTerm(NamedTuple):
    """S of one level, positive semidefinite, and where it pulls accelerations to."""

    matrix: Array  # (d, d) P S P, negative eigenvalues set to 0
    pull: Array  # (d,) S (kd v): subtract it, and S y_0, from the right side


def second_order(reduced: ReducedProblem) -> SecondOrder:
    """Terms of the problem.

    Raises:
        ValueError: the problem has none.
    """
    terms = reduced.source.second_order
    if terms is None:
        raise ValueError("the control problem has no second-order terms")
    return terms


def level_term(
    reduced: ReducedProblem, tasks: Sequence[int], above: Array, projector: Array
) -> LevelTerm:
    """S_l = P [own terms of its tasks + sum over rows above of lambda_r grad^2 f_r] P.

    lambda = (A A^T + 1e-4 I)^-1 A J_l^T e_l are the multipliers of the rows A above.

    Args:
        tasks: tasks of the level.
        above: (m,) in [0, 1], how far each row is above this level.
        projector: P (d, d) of what the levels above leave.
    """
    if not tasks:
        d = reduced.jacobian.shape[1]
        return LevelTerm(np.zeros((d, d)), np.zeros(d))
    terms, starts, J = second_order(reduced), reduced.source.starts, reduced.jacobian
    S = np.sum(terms.own[list(tasks)], axis=0)
    gradient = np.zeros(J.shape[1])
    for i in tasks:
        part = slice(starts[i], starts[i + 1])
        gradient += terms.error[part] @ J[part]
    rows = np.flatnonzero(above > 0.0)
    if len(rows):
        A = above[rows, None] * J[rows]
        gram = A @ A.T + _MULTIPLIER_DAMPING * np.eye(len(rows))
        weights = above[rows] * np.linalg.solve(gram, A @ gradient)
        S = S + np.tensordot(weights, terms.rows[rows], 1)
    velocity = reduced.source.velocity
    if reduced.basis is not None:
        S, velocity = reduced.basis.T @ S @ reduced.basis, reduced.basis.T @ velocity
    matrix = positive_part(projector @ S @ projector)
    rate = float(np.mean(terms.rate[list(tasks)]))
    return LevelTerm(matrix, rate * (matrix @ velocity))


def projected_terms(
    reduced: ReducedProblem, projectors: Array, origin: Array
) -> tuple[Array, Array]:
    """sum_i P_i S_i (d, d) and sum_i P_i S_i (kd_i v + y_0) (d,) over the active tasks.

    Args:
        projectors: (k, d, d). origin: y_0 (d,), from which accelerations are measured.
    """
    source = reduced.source
    k, d = len(projectors), reduced.jacobian.shape[1]
    task_of = np.repeat(np.arange(k), np.diff(source.starts))
    active = np.diag(source.alpha) < 1.0
    system, pull = np.zeros((d, d)), np.zeros(d)
    for i in np.flatnonzero(active):
        share = np.where(active & (np.arange(k) != i), source.alpha[i], 0.0)
        term = level_term(reduced, [int(i)], share[task_of], projectors[i])
        system += projectors[i] @ term.matrix
        pull += projectors[i] @ (term.pull + term.matrix @ origin)
    return system, pull


def weighted_terms(reduced: ReducedProblem, weights: Array, origin: Array) -> tuple[Array, Array]:
    """sum_i gamma_i S_i (d, d) and sum_i gamma_i S_i (kd_i v + y_0) (d,); weights (k,).

    A sum of weighted costs has no levels, so no multipliers.
    """
    d = reduced.jacobian.shape[1]
    nothing, whole = np.zeros(reduced.jacobian.shape[0]), np.eye(d)
    system, pull = np.zeros((d, d)), np.zeros(d)
    for i in np.flatnonzero(weights > 0.0):
        term = level_term(reduced, [int(i)], nothing, whole)
        system += weights[i] * term.matrix
        pull += weights[i] * (term.pull + term.matrix @ origin)
    return system, pull


def guarded_solve(system: Array, right: Array, guard: float) -> Array:
    """x (d,) of A x = r; below `guard` on 1 / |A^-1|_F a damping grows from zero.

    As in `balanced_target`: without it torques jump in ramps through a singular A.
    """
    sigma = 0.0
    if np.linalg.matrix_rank(system) == len(system):
        inverse = np.linalg.inv(system)
        sigma = 1.0 / float(np.linalg.norm(inverse))
        if sigma >= guard:
            return np.asarray(inverse @ right)
    normal = system.T @ system + (guard**2 - sigma**2) * np.eye(len(system))
    return np.asarray(np.linalg.solve(normal, system.T @ right))


def positive_part(matrix: Array) -> Array:
    """Symmetric matrix (d, d) with its negative eigenvalues set to 0."""
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T)
