"""Operation counts of one control step of the laws compared by Jeong and Chang (2009).

A multiplication with its addition is one operation. Shapes: n joints, m_i rows of level i. Counted
are dense products; what every law needs alike (Jacobians, targets, bias) is left out. A
decomposition of an (m, n) matrix counts as in Golub and Van Loan (1996): 5.4.5 for the SVD of
J^T with both factors, 8.3 for a symmetric one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

Count = Callable[[int, Sequence[int]], float]


def _svd(m: int, n: int) -> float:
    return 7.0 * n * m**2 + 5.5 * m**3


def _symmetric(m: int) -> float:
    return 4.5 * m**3


def inverse(n: int) -> float:
    """M^-1 from its Cholesky factor."""
    return n**3 / 2.0


def inverse_dynamics(n: int) -> float:
    """Recursive Newton-Euler, Featherstone (2008), table 10.1: 130 n products at most."""
    return 130.0 * n - 68.0


def mass_matrix(n: int) -> float:
    """Composite rigid bodies, the same table: a chain, which is the worst case."""
    return 10.0 * n**2 + 22.0 * n - 32.0


def task_priority(n: int, rows: Sequence[int]) -> float:
    """Two passes of Gram-Schmidt, one small system per level, inverse dynamics."""
    total, rank = inverse_dynamics(n), 0
    for m in rows:
        for _ in range(m):  # all rows independent
            total += 4.0 * n * rank + 2.0 * n
            rank += 1
        total += n * m**2 + n * m + m**3 + m**3 / 3.0 + m**2 + n * m  # C, r, C^T C, solve, x
    return total


def resolved_acceleration(n: int, rows: Sequence[int]) -> float:
    """J_i N_i, its SVD, x and N_i (n, n), then inverse dynamics."""
    total = inverse_dynamics(n)
    for m in rows:
        total += m * n**2 + _svd(m, n) + 2.0 * m * n + m**2 + m * n**2
    return total


def operational_space(n: int, rows: Sequence[int]) -> float:
    """M and M^-1, J_i N_i, both inertias of the task, x and N_i."""
    total = mass_matrix(n) + inverse(n) + n**2  # tau = M x
    for m in rows:
        total += m * n**2  # J_i N_i
        total += 2.0 * (m * n**2 + n * m**2)  # J M^-1 J^T of J_i and of J_i N_i
        total += _symmetric(m) + n * m**2  # Lambda, M^-1 J^T Lambda
        total += 2.0 * m * n + m**2 + m * n**2  # x, N_i
    return total


def unifying(n: int, rows: Sequence[int]) -> float:
    """M, M^-2, the weighted inverse of J_i, x and the product of projectors."""
    total = mass_matrix(n) + inverse(n) + n**3 / 2.0 + n**2  # M^-2 is symmetric
    for m in rows:
        total += m * n**2 + n * m**2 + _symmetric(m) + n * m**2  # J W^-1 J^T, J^{W+}
        total += n * m + n**2  # N_i (J^{W+} b)
        total += 2.0 * m * n**2  # N_i J^{W+} J
    return total


COUNTS: dict[str, Count] = {
    "task_priority": task_priority,
    "resolved_acceleration": resolved_acceleration,
    "unifying": unifying,
    "operational_space": operational_space,
}
