"""Solves the levels of one step in sequence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ghc_controller.kinematics.level_kernels import bounded_level, multipliers, null_space_of
from ghc_controller.kinematics.level_rows import LevelRows
from ghc_controller.kinematics.settings import SECOND_ORDER, KinematicSettings
from ghc_controller.kinematics.step_record import StepRecord
from ghc_controller.types import Array

_TOUCHED = 1e-9  # [m], [rad] bounds closer than this are active
_NO_EXCESS = 1e-10  # [m], [rad] smaller excess is ignored
_AT_BOUND = 1e-12  # [rad], [m] of the bounds of the step


class Cascade:
    """State between two levels: current solution, remaining null space, bounds to be satisfied.

    An augmented level fixes R dq in addition to J dq, which leaves no coordinate of its chain to
    the levels below, as in the paper (T15, T16).
    """

    def __init__(self, n: int, settings: KinematicSettings, lower: Array, upper: Array) -> None:
        """lower, upper: (n,) bounds of the step, with 0 between them."""
        self._settings = settings
        self._keeps_multipliers = settings.model in SECOND_ORDER
        self._x, self._null_space = np.zeros(n), np.eye(n)
        self._lower, self._upper = lower, upper
        self._C, self._low, self._high = np.eye(n), lower, upper
        self._held: list[tuple[int | None, Array, NDArray[np.bool_]]] = []  # level, rows, which
        self._residuals: list[Array] = []
        self._multipliers: dict[tuple[int, int], Array] = {}
        self._unsolved = 0

    def add(self, index: int, level: LevelRows, root: Array | None) -> None:
        """Solve one level, root R (k, n) of its second-order term."""
        if level.equality:
            self._add_equality(index, level, root)
        else:
            self._add_inequality(index, level, root)

    def finish(self, levels: Sequence[LevelRows], last: StepRecord | None) -> StepRecord:
        """Minimize |dq| in the remaining null space; returns the record of the step."""
        n = len(self._x)
        if self._null_space.shape[1]:
            self._minimize(np.eye(n), np.zeros(n))
        active = tuple(self._active(level) for level in levels)
        changed = tuple(
            last is not None and bool(np.any(rows != before))
            for rows, before in zip(active, last.active if last else active, strict=True)
        )
        return StepRecord(
            self._x,
            tuple(level.jacobian.copy() for level in levels),
            tuple(self._residuals),
            active,
            changed,
            self._multipliers,
            self._unsolved,
        )

    def _minimize(self, rows: Array, right: Array) -> Array:
        """Bounded least squares in the null space; returns the remaining null space."""
        x, solved, left = bounded_level(
            rows,
            right,
            self._x,
            self._null_space,
            self._C,
            self._low,
            self._high,
            self._settings.regularization,
            self._settings.rank_tolerance,
        )
        self._x = x
        self._unsolved += not solved
        return left

    def _add_equality(self, index: int, level: LevelRows, root: Array | None) -> None:
        J, e = level.jacobian, level.lower
        n = len(self._x)
        if self._null_space.shape[1]:
            if self._settings.model == "dhqp":
                rows = np.vstack([J, self._settings.damping * np.eye(n)])
                self._minimize(rows, np.concatenate([e, np.zeros(n)]))
                tolerance = self._settings.rank_tolerance
                left = null_space_of(J, self._null_space, tolerance)
            elif root is None:
                left = self._minimize(J, e)
            else:
                rows = np.vstack([J, root])
                left = self._minimize(rows, np.concatenate([e, np.zeros(len(root))]))
            self._null_space = left
        w = J @ self._x - e
        self._residuals.append(w)
        self._remember(index, level, root, w, np.ones(len(J), dtype=np.bool_))

    def _add_inequality(self, index: int, level: LevelRows, root: Array | None) -> None:
        J, d = level.jacobian, self._null_space.shape[1]
        w = _excess(level, self._x)
        if d and w.any():
            self._relax(level, root, w)
            w = _excess(level, self._x)
        w[np.abs(w) < _NO_EXCESS] = 0.0
        self._residuals.append(w)
        value = J @ self._x
        self._C = np.vstack([self._C, J])
        self._low = np.concatenate([self._low, np.minimum(level.lower, value)])
        self._high = np.concatenate([self._high, np.maximum(level.upper, value)])
        held = J[w != 0.0] if root is None else np.vstack([J[w != 0.0], root])
        if len(held) and self._null_space.shape[1]:
            self._null_space = null_space_of(held, self._null_space, self._settings.rank_tolerance)
        self._remember(index, level, root, w, self._active(level))

    def _relax(self, level: LevelRows, root: Array | None, excess: Array) -> None:
        """min |w|^2 + |R dq|^2 subject to lower <= J dq - w <= upper, from a feasible (x, w)."""
        n, m = len(self._x), len(excess)
        weight = np.zeros((0, n)) if root is None else root
        if self._settings.model == "dhqp":
            weight = self._settings.damping * np.eye(n)
        k, r = len(weight), len(self._C)
        rows, bounds = np.zeros((k + m, n + m)), np.zeros((r + m, n + m))
        rows[:k, :n], rows[k:, n:] = weight, np.eye(m)
        bounds[:r, :n], bounds[r:, :n], bounds[r:, n:] = self._C, level.jacobian, -np.eye(m)
        d = self._null_space.shape[1]
        space = np.zeros((n + m, d + m))
        space[:n, :d], space[n:, d:] = self._null_space, np.eye(m)
        x, solved, _ = bounded_level(
            rows,
            np.zeros(k + m),
            np.concatenate([self._x, excess]),
            space,
            bounds,
            np.concatenate([self._low, level.lower]),
            np.concatenate([self._high, level.upper]),
            self._settings.regularization,
            self._settings.rank_tolerance,
        )
        self._x = np.ascontiguousarray(x[:n])
        self._unsolved += not solved

    def _active(self, level: LevelRows) -> NDArray[np.bool_]:
        if level.equality:
            return np.ones(len(level.jacobian), dtype=np.bool_)
        value = level.jacobian @ self._x
        return (value >= level.upper - _TOUCHED) | (value <= level.lower + _TOUCHED)

    def _remember(
        self,
        index: int,
        level: LevelRows,
        root: Array | None,
        w: Array,
        active: NDArray[np.bool_],
    ) -> None:
        """Multipliers of this level: lambda_{l,l} = w, those of levels above by stationarity."""
        if not self._keeps_multipliers:
            return
        if w.any():
            self._multipliers[(index, index)] = w
            if self._held:
                gradient = w @ level.jacobian
                if root is not None:
                    gradient = gradient + root.T @ (root @ self._x)
                self._solve_multipliers(index, gradient)
        self._held.append((index, level.jacobian, active))
        if root is not None:
            self._held.append((None, root, np.ones(len(root), dtype=np.bool_)))

    def _solve_multipliers(self, index: int, gradient: Array) -> None:
        rows = np.vstack([rows[which] for _, rows, which in self._held])
        if not len(rows):
            return
        x = self._x
        free = (x > self._lower + _AT_BOUND) & (x < self._upper - _AT_BOUND)
        found = multipliers(rows, gradient, free.astype(np.float64))
        offset = 0
        for level, block, which in self._held:
            count = int(which.sum())
            if level is not None:
                weights = np.zeros(len(block))
                weights[which] = found[offset : offset + count]
                self._multipliers[(level, index)] = weights
            offset += count


def _excess(level: LevelRows, x: Array) -> Array:
    """(m,) violation of the bounds by J x."""
    value = level.jacobian @ x
    beyond = np.maximum(value - level.upper, 0.0) + np.minimum(value - level.lower, 0.0)
    return np.where(np.abs(beyond) > _AT_BOUND, beyond, 0.0)
