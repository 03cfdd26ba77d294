"""Compiled dual active-set method of Goldfarb and Idnani for a strictly convex dense QP.

D. Goldfarb, A. Idnani: A numerically stable dual method for solving strictly convex quadratic
programs, Mathematical Programming 27, 1983. The step directions of section 3 come from an
orthogonal factor that is updated by Givens rotations (section 4); rows have two sides, equalities
are never dropped. n variables, e equalities, r two-sided rows, q active rows.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from ghc_controller.small_factors import REORDERED_SUMS, inverse_factor
from ghc_controller.types import Array

SOLVED, INFEASIBLE, LIMIT, FAILED = 0, 1, 2, 3
_SKIPPED = 2

_FEASIBLE = 1e-14  # [-] of 1 + |x|: a normalized row violated by less is met
_AGREES = 1e-10  # [-] of 1 + |x|: violation of a dependent row that is rounding, no conflict
_DEPENDENT = 1e-11  # [-] what is left of a normalized row that depends on the active ones
_REFINEMENTS = 2  # corrections of the answer on its active rows


@njit(cache=True, fastmath=REORDERED_SUMS)
def _dot(a: Array, b: Array) -> float:  # pragma: no cover
    value = 0.0
    for c in range(a.shape[0]):
        value += a[c] * b[c]
    return value


@njit(cache=True)
def _most_violated(
    rows: Array, lower: Array, upper: Array, norm: Array, side: Array, x: Array
) -> tuple[int, int, float]:  # pragma: no cover
    """Row, side (+1 lower, -1 upper) and violation over its norm; rows with a side are skipped."""
    worst, row, sign = 0.0, -1, 0
    for r in range(rows.shape[0]):
        value = _dot(rows[r], x)
        below, above = (lower[r] - value) / norm[r], (value - upper[r]) / norm[r]
        if (side[r] == 0 or side[r] == -1) and below > worst:
            worst, row, sign = below, r, 1
        if (side[r] == 0 or side[r] == 1) and above > worst:
            worst, row, sign = above, r, -1
    return row, sign, worst


@njit(cache=True)
def _add(basis: Array, triangle: Array, d: Array, q: int) -> None:  # pragma: no cover
    """Rotate entries q.. of d (n,) into d[q], and append d[:q + 1] as column q of the triangle."""
    n = d.shape[0]
    for k in range(n - 1, q, -1):
        if d[k] == 0.0:
            continue
        length = math.hypot(d[k - 1], d[k])
        cosine, sine = d[k - 1] / length, d[k] / length
        d[k - 1], d[k] = length, 0.0
        for c in range(n):
            upper, under = basis[k - 1, c], basis[k, c]
            basis[k - 1, c] = cosine * upper + sine * under
            basis[k, c] = cosine * under - sine * upper
    for r in range(q + 1):
        triangle[r, q] = d[r]


@njit(cache=True)
def _drop(basis: Array, triangle: Array, column: int, q: int) -> None:  # pragma: no cover
    """Take a column out of the triangle (q columns) and make it triangular again."""
    n = basis.shape[0]
    for c in range(column, q - 1):
        for r in range(c + 2):
            triangle[r, c] = triangle[r, c + 1]
        length = math.hypot(triangle[c, c], triangle[c + 1, c])
        if length == 0.0:
            continue
        cosine, sine = triangle[c, c] / length, triangle[c + 1, c] / length
        triangle[c, c], triangle[c + 1, c] = length, 0.0
        for k in range(c + 2, q):
            upper, under = triangle[c, k], triangle[c + 1, k]
            triangle[c, k] = cosine * upper + sine * under
            triangle[c + 1, k] = cosine * under - sine * upper
        for k in range(n):
            upper, under = basis[c, k], basis[c + 1, k]
            basis[c, k] = cosine * upper + sine * under
            basis[c + 1, k] = cosine * under - sine * upper


@njit(cache=True)
def _solve_upper(triangle: Array, right: Array, q: int) -> Array:  # pragma: no cover
    """(q,) of triangle[:q, :q] r = right[:q]."""
    r = np.empty(q)
    for k in range(q - 1, -1, -1):
        value = right[k]
        for c in range(k + 1, q):
            value -= triangle[k, c] * r[c]
        r[k] = value / triangle[k, k]
    return r


@njit(cache=True)
def _refine(
    basis: Array, triangle: Array, normals: Array, values: Array, x: Array, q: int
) -> None:  # pragma: no cover
    """Move x (n,) by the least step after which its q active rows hold."""
    step = np.empty(q)
    for k in range(q):  # triangle^T step = what is missing
        value = values[k] - _dot(normals[k], x)
        for c in range(k):
            value -= triangle[c, k] * step[c]
        step[k] = value / triangle[k, k]
    for k in range(q):
        for c in range(x.shape[0]):
            x[c] += step[k] * basis[k, c]


@njit(cache=True)
def solve_dual(
    hessian: Array,
    linear: Array,
    equalities: Array,
    right: Array,
    rows: Array,
    lower: Array,
    upper: Array,
    limit: int,
) -> tuple[int, int, Array, Array, Array]:  # pragma: no cover
    """min 1/2 x^T H x + g^T x subject to A x = b and l <= C x <= u.

    Args:
        hessian: (n, n) positive definite. linear: (n,). equalities: (e, n), right: (e,).
        rows: (r, n), lower, upper: (r,). limit: number of pivots.

    Returns:
        How it ended, pivots, x (n,), multipliers (e,) and (r,) in the signs of QpResult.
    """
    n, e, count = linear.shape[0], right.shape[0], rows.shape[0]
    factor = inverse_factor(hessian)  # H^-1 = F F^T
    basis = np.ascontiguousarray(factor.T)  # row k: direction k, conjugate in H
    x = -(factor @ (factor.T @ linear))
    triangle, normals, values = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
    active, multiplier = np.full(n, -1), np.zeros(n)  # rows behind the e equalities
    # +1 active at the lower bound, -1 at the upper one, _SKIPPED: depends and agrees
    side = np.zeros(count, dtype=np.int64)
    y, z = np.zeros(e), np.zeros(count)
    sign_of = np.zeros(n)
    norm = np.empty(count)
    for r in range(count):
        if lower[r] > upper[r]:
            return INFEASIBLE, 0, x, y, z
        norm[r] = max(math.sqrt(_dot(rows[r], rows[r])), 1e-300)
    q, pivots, next_equality = 0, 0, 0
    normal = np.empty(n)
    while True:
        size = 1.0 + math.sqrt(_dot(x, x))
        if not math.isfinite(size):
            return FAILED, pivots, x, y, z
        if next_equality < e:
            row = next_equality
            next_equality += 1
            length = max(math.sqrt(_dot(equalities[row], equalities[row])), 1e-300)
            violation = (right[row] - _dot(equalities[row], x)) / length
            sign = 1 if violation >= 0.0 else -1
            violation = abs(violation)
            for c in range(n):
                normal[c] = sign * equalities[row, c] / length
            value = sign * right[row] / length
            is_equality = True
        else:
            row, sign, violation = _most_violated(rows, lower, upper, norm, side, x)
            if row < 0 or violation <= _FEASIBLE * size:
                break
            length = norm[row]
            for c in range(n):
                normal[c] = sign * rows[row, c] / length
            value = (lower[row] if sign > 0 else -upper[row]) / length
            is_equality = False
        added = 0.0
        while True:
            if pivots >= limit:
                return LIMIT, pivots, x, y, z
            pivots += 1
            d = basis @ normal
            whole, free = _dot(d, d), _dot(d[q:], d[q:])
            step = _solve_upper(triangle, d, q)
            blocking, dual_step = -1, np.inf
            for k in range(q):
                if active[k] >= e and step[k] > 0.0 and multiplier[k] < dual_step * step[k]:
                    blocking, dual_step = k, multiplier[k] / step[k]
            dependent = q == n or free <= _DEPENDENT * _DEPENDENT * whole
            agrees = dependent and violation <= _AGREES * size
            if agrees and is_equality:
                break  # depends on the others and agrees with them
            if dependent and blocking < 0:
                if not agrees:
                    return INFEASIBLE, pivots, x, y, z
                side[row] = _SKIPPED  # until x moves on
                break
            primal_step = np.inf if dependent else violation / free
            length_step = min(dual_step, primal_step)
            for k in range(q):
                multiplier[k] -= length_step * step[k]
            added += length_step
            if not dependent:
                for k in range(q, n):
                    for c in range(n):
                        x[c] += length_step * d[k] * basis[k, c]
            if primal_step <= dual_step:
                _add(basis, triangle, d, q)
                normals[q], values[q], sign_of[q] = normal, value, sign / length
                active[q], multiplier[q] = (row if is_equality else e + row), added
                if not is_equality:
                    side[row] = sign
                q += 1
                for r in range(count):
                    if side[r] == _SKIPPED:
                        side[r] = 0
                break
            side[active[blocking] - e] = 0
            _drop(basis, triangle, blocking, q)
            for k in range(blocking, q - 1):
                normals[k], values[k], sign_of[k] = normals[k + 1], values[k + 1], sign_of[k + 1]
                active[k], multiplier[k] = active[k + 1], multiplier[k + 1]
            q -= 1
            violation = value - _dot(normal, x)
            if violation <= 0.0 and not is_equality:
                violation = 0.0
    for _ in range(_REFINEMENTS):
        _refine(basis, triangle, normals, values, x, q)
    for k in range(q):
        if active[k] < e:
            y[active[k]] = -multiplier[k] * sign_of[k]
        else:
            z[active[k] - e] = -multiplier[k] * sign_of[k]
    return SOLVED, pivots, x, y, z
