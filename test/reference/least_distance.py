"""Least-squares QPs by a dual active-set method: the solver of the reference cascade.

min 1/2 |A z - c|^2 subject to E z = e and G z >= h becomes a least-distance problem
min 1/2 |s|^2, rows s >= right (Lawson and Hanson, Solving Least Squares Problems, chapter 23).
Where the active set that SciPy's NNLS finds misses the KKT conditions, that one is solved by the
method of Goldfarb and Idnani (Mathematical Programming 27, 1983), with every step computed anew
by an SVD instead of by updated factors: slow and accurate.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr, solve_triangular
from scipy.optimize import nnls

Array = NDArray[np.float64]

_RANK = 1e-10  # [-] of the largest singular value of the equations
_TOLERANCE = 1e-13  # [-] violation of a row, times the size of the answer
_DEPENDENT = 1e-9  # [-] part of a row outside the span of the active ones, below: none
_MISSED = 1e-7  # [-] violation, times the size of the answer, from which no point meets the rows
_PIVOTS = 1000


class Infeasible(ValueError):
    """No point meets all rows."""


class Optimum(NamedTuple):
    """Optimum of a QP and how well it meets the KKT conditions, in the scale of s."""

    z: Array  # (p,)
    multipliers: Array  # (r,) of the normalized rows, >= 0
    primal: float  # largest violation of a normalized row
    dual: float  # |s - rows^T multipliers| / max(1, |s|)
    complementarity: float  # largest multiplier x distance / max(1, |s|)^2


def least_squares(A: Array, c: Array, E: Array, e: Array, G: Array, h: Array) -> Optimum:
    """Minimizer of 1/2 |A z - c|^2 with E z = e and G z >= h.

    Args:
        A: (m, p), full column rank on the null space of E. c: (m,).
        E: (q, p), rank-deficient rows allowed. e: (q,).
        G: (r, p). h: (r,), -inf for no bound.

    Raises:
        Infeasible: no such point.
    """
    start, basis = _solutions(E, e, A.shape[1])
    if basis.shape[1] == 0:
        if np.any(G @ start < h - 1e-9 * np.maximum(1.0, np.linalg.norm(G, axis=1))):
            raise Infeasible
        return Optimum(start, np.zeros(len(h)), 0.0, 0.0, 0.0)
    orthogonal, triangle = qr(A @ basis, mode="economic")
    middle = orthogonal.T @ (c - A @ start)
    rows = solve_triangular(triangle, (G @ basis).T, trans="T").T
    right = h - G @ start - rows @ middle
    norm = np.linalg.norm(rows, axis=1)
    size = np.linalg.norm(G, axis=1) * np.linalg.norm(1.0 / np.abs(np.diag(triangle)))
    fixed = norm <= 1e-13 * np.maximum(size, 1e-300)
    if np.any(right[fixed] > 1e-9 * np.maximum(1.0, np.abs(h[fixed]))):
        raise Infeasible
    kept = np.flatnonzero(~fixed & np.isfinite(h))
    rows, right = rows[kept] / norm[kept, None], right[kept] / norm[kept]
    s, some = _least_distance(rows, right)
    multipliers = np.zeros(len(h))
    multipliers[kept] = some
    length = max(1.0, float(np.linalg.norm(s)))
    away = rows @ s - right
    if np.any(away < -_MISSED * length):
        raise Infeasible
    return Optimum(
        start + basis @ solve_triangular(triangle, s + middle),
        multipliers,
        float(np.max(-away, initial=0.0)),
        float(np.linalg.norm(s - rows.T @ some)) / length,
        float(np.max(some * np.abs(away), initial=0.0)) / length**2,
    )


def _solutions(E: Array, e: Array, p: int) -> tuple[Array, Array]:
    """One solution (p,) of E z = e and a basis (p, d) of E z = 0."""
    if E.shape[0] == 0:
        return np.zeros(p), np.eye(p)
    left, sigma, right = np.linalg.svd(E)
    rank = int(np.sum(sigma > _RANK * max(float(sigma.max(initial=0.0)), 1e-300)))
    least = right[:rank].T @ ((left[:, :rank].T @ e) / sigma[:rank])
    if np.max(np.abs(E @ least - e)) > 1e-8 * max(1.0, float(np.abs(e).max())):
        raise Infeasible
    return least, right[rank:].T


def _least_distance(rows: Array, right: Array) -> tuple[Array, Array]:
    """Shortest s (d,) with rows s >= right, and multipliers (r,). Rows have length 1."""
    guess = _by_nnls(rows, right)
    if guess is not None:
        return guess
    s, multipliers = np.zeros(rows.shape[1]), np.zeros(len(right))
    active: list[int] = []
    done: list[int] = []  # rows that depend on active ones and are missed by rounding only
    for _ in range(_PIVOTS):
        missing = right - rows @ s
        missing[active + done] = 0.0
        tolerance = _TOLERANCE * max(1.0, float(np.linalg.norm(s)))
        if missing.max(initial=0.0) <= tolerance:
            return s, multipliers
        new = int(np.argmax(missing))
        if not _add(rows, right, new, active, multipliers):
            if missing[new] > _MISSED * max(1.0, float(np.linalg.norm(s))):
                raise Infeasible
            done.append(new)
        # From the active rows alone, so that rounding of the steps does not add up.
        s = _solve(rows[active], right[active])
        multipliers[:] = 0.0
        multipliers[active] = np.maximum(_solve(rows[active].T, s), 0.0)
    return s, multipliers  # the KKT residuals tell


def _by_nnls(rows: Array, right: Array) -> tuple[Array, Array] | None:
    """The same by the active set that SciPy's NNLS finds, if it meets the KKT conditions.

    It does in most problems and saves the pivots (Lawson and Hanson, chapter 23.4).
    """
    scale = float(np.max(right, initial=0.0))
    if scale <= 0.0:
        return np.zeros(rows.shape[1]), np.zeros(len(right))
    wanted = np.append(np.zeros(rows.shape[1]), 1.0)
    try:
        weights, _ = nnls(np.vstack([rows.T, right / scale]), wanted)
    except RuntimeError:  # too many iterations
        return None
    active = np.flatnonzero(weights > 0.0)
    s, multipliers = _solve(rows[active], right[active]), np.zeros(len(right))
    multipliers[active] = _solve(rows[active].T, s)
    tolerance = _TOLERANCE * max(1.0, float(np.linalg.norm(s)))
    small = max(np.max(right - rows @ s), np.max(np.abs(s - rows.T @ multipliers))) <= tolerance
    return (s, multipliers) if small and multipliers.min() >= 0.0 else None


def _add(rows: Array, right: Array, new: int, active: list[int], multipliers: Array) -> bool:
    """Make one violated row active; rows whose multiplier would turn negative leave.

    False where no step exists: the row contradicts the active ones. Changes `active` and
    `multipliers`, for which s = rows^T multipliers before and after.
    """
    while True:
        share = _solve(rows[active].T, rows[new])
        away = rows[new] - share @ rows[active]
        length = float(away @ away)
        missing = right[new] - rows[new] @ (rows.T @ multipliers)
        step = missing / length if length > _DEPENDENT**2 else np.inf
        ratios = [
            multipliers[j] / r if r > 0.0 else np.inf for j, r in zip(active, share, strict=True)
        ]
        least = min(ratios, default=np.inf)
        if not np.isfinite(min(step, least)):
            multipliers[new] = 0.0
            return False
        multipliers[active] -= min(step, least) * share
        multipliers[new] += min(step, least)
        if step <= least:
            active.append(new)
            return True
        leaving = active.pop(ratios.index(least))
        multipliers[leaving] = 0.0


def _solve(matrix: Array, right: Array) -> Array:
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-13)[0], dtype=np.float64)
