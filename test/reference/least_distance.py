"""Least-squares QPs by NNLS: the solver of the reference cascade, NumPy and SciPy only.

min 1/2 |A z - c|^2 subject to E z = e and G z >= h becomes a least-distance problem
min 1/2 |s|^2, rows s >= right (Lawson and Hanson, Solving Least Squares Problems, chapter 23),
which SciPy's NNLS solves. The active set that it finds is then refined by plain linear algebra,
because NNLS alone is accurate to about 1e-8 only.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr, solve_triangular
from scipy.optimize import nnls

Array = NDArray[np.float64]

_RANK = 1e-10  # [-] of the largest singular value of the equations
_INFEASIBLE = 1e-9  # [-] last entry of the NNLS residual, 1/2 for a well-chosen scale
_SCALES = 10  # trials of a scale
_TOLERANCE = 1e-12  # [-] of the refined active set, times the size of the answer
_ROUNDS = 200  # changes of the active set


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
    """Shortest s (d,) with rows s >= right, and multipliers (r,)."""
    d, r = rows.shape[1], rows.shape[0]
    scale = float(np.max(right, initial=0.0))
    if scale <= 0.0:
        return np.zeros(d), np.zeros(r)
    s, positive = None, np.zeros(r, dtype=bool)
    for _ in range(_SCALES):
        found = _at_scale(rows, right, scale)
        if found is None:
            scale *= 30.0
            continue
        s, positive = found
        length = float(np.linalg.norm(s))
        if 0.1 * scale <= length <= 10.0 * scale:  # where NNLS is most accurate
            break
        scale = length
    if s is None:
        raise Infeasible
    return _refined(rows, right, positive, s)


def _at_scale(rows: Array, right: Array, scale: float) -> tuple[Array, Array] | None:
    """s (d,) and its active rows, for right sides in units of `scale`; None if it seems too far.

    The last entry of the NNLS residual is -1 / (1 + |s / scale|^2), 0 without a feasible point.
    """
    d, r = rows.shape[1], rows.shape[0]
    wanted = np.append(np.zeros(d), 1.0)
    weights, _ = nnls(np.vstack([rows.T, right / scale]), wanted, maxiter=100 * (d + r))
    rest = np.append(rows.T @ weights, right @ weights / scale) - wanted
    if -rest[-1] < _INFEASIBLE:
        return None
    return -scale * rest[:d] / rest[-1], weights > 0.0


def _refined(rows: Array, right: Array, active: Array, s: Array) -> tuple[Array, Array]:
    """The same optimum from its active rows, changed while they miss the KKT conditions."""
    tolerance = _TOLERANCE * max(1.0, float(np.linalg.norm(s)))
    for _ in range(_ROUNDS):
        index = np.flatnonzero(active)
        if len(index) == 0:
            active[int(np.argmax(right))] = True
            continue
        s = np.linalg.lstsq(rows[index], right[index], rcond=1e-11)[0]
        weights, miss = nnls(rows[index].T, s, maxiter=100 * (len(index) + len(s)))
        if miss > tolerance:  # some row holds s back from the wrong side
            signed = np.linalg.lstsq(rows[index].T, s, rcond=1e-11)[0]
            active[index[int(np.argmin(signed))]] = False
            continue
        missing = right - rows @ s
        missing[active] = 0.0
        if missing.max(initial=0.0) <= tolerance:
            break
        active[int(np.argmax(missing))] = True
    multipliers = np.zeros(len(right))
    multipliers[index] = weights
    return s, multipliers
