"""Generalized projectors of the GHC paper (algorithms 1 and 2), compiled."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from ghc_controller.hierarchy.directions import (
    Starts,
    add_directions,
    descending_order,
    selected_values,
    subtract_direction,
    write_scaled_identity,
)
from ghc_controller.hierarchy.soft_null_space import append_rows
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class ProjectorSettings:
    """How linear dependence between task rows is decided.

    Raises:
        InvalidValue: a number outside its range.
    """

    rank_tolerance: float = declared(
        "of a row's norm: what is left of it counts as a direction of the projectors",
        1e-7,
        unit="-",
        domain=POSITIVE,
        name="projector_rank_tolerance",
    )
    layer_damping: float = declared(
        "damped projector layers: continuous at rank changes; 0 = exact, "
        "negative = of the formulation: balanced 2.5e-6, the others 0",
        -1.0,
        unit="-",
    )

    def __post_init__(self) -> None:
        check(self)

    def with_default(self, layer_damping: float) -> ProjectorSettings:
        """The same settings, with this damping where none is given."""
        return self if self.layer_damping >= 0.0 else replace(self, layer_damping=layer_damping)


@njit(cache=True)
def write_projectors(
    jacobian: Array,
    starts: Starts,
    alpha: Array,
    rank_tolerance: float,
    damping: float,
    out: Array,
) -> None:  # pragma: no cover
    """P_i = I - B^T A^{r,s} B (eq. 11); writes `out` (k, n, n).

    Without damping B comes from two-pass Gram-Schmidt. With damping e > 0 it is L^-1 J of
    L L^T = J J^T + e^2 I over the rows in their order (of rows longer than 1, e in proportion):
    the first l tasks then give J_l^T (J_l J_l^T + e^2 I)^-1 J_l, which is continuous in q
    through rank changes.

    Tasks with alpha = 0 come last and enter with coefficient 0: they are not looked at. The basis
    of one task is continued for the next one as far as their tasks agree. A posture of all joints
    completes the exact basis: its directions are all that is left, which needs no Gram-Schmidt.
    """
    k, n = alpha.shape[0], jacobian.shape[1]
    dominance = np.zeros(k)
    completes = np.zeros(k, dtype=np.bool_)
    for i in range(k):
        rows = jacobian[starts[i] : starts[i + 1]]
        if damping == 0.0:
            completes[i] = rows.shape[0] == n and selected_values(rows)[0]
        for j in range(k):
            dominance[j] += alpha[i, j]
    basis = np.empty((max(n, jacobian.shape[0]), n))
    chain = np.empty(k, dtype=np.int64)  # tasks whose directions are in the basis
    rank_after = np.zeros(k + 1, dtype=np.int64)  # of the first 0 .. k tasks of the chain
    length = 0
    for i in range(k):
        order = descending_order(alpha[i], dominance)
        above = 0
        while above < k and alpha[i, order[above]] > 0.0:
            above += 1
            if completes[order[above - 1]]:
                break
        shared = 0
        while shared < min(length, above) and chain[shared] == order[shared]:
            shared += 1
        for position in range(shared, above):
            task = order[position]
            rank = rank_after[position]
            first, last = starts[task], starts[task + 1]
            if damping > 0.0:
                rank = append_rows(jacobian[first:last], damping, basis, rank)
            elif not completes[task]:
                rank = add_directions(jacobian, first, last, rank_tolerance, basis, rank)
            rank_after[position + 1] = rank
            chain[position] = task
            length = position + 1
        rest = 0.0  # weight of the directions that are not in the basis
        if above > 0 and completes[order[above - 1]]:
            rest = alpha[i, order[above - 1]]
        write_scaled_identity(1.0 - rest, out[i])
        for position in range(above):
            weight = alpha[i, order[position]] - rest
            for b in range(rank_after[position], rank_after[position + 1]):
                subtract_direction(weight, basis[b], out[i])


def generalized_projectors(
    jacobian: Array,
    starts: Starts,
    alpha: Array,
    settings: ProjectorSettings | None = None,
) -> Array:
    """Generalized projectors P_i(A_i) of all tasks (GHC paper, algorithms 1 and 2).

    Args:
        jacobian: (m, n) augmented Jacobian, eq. 10.
        starts: (k + 1,) first row of each task; the last entry is m.
        alpha: (k, k) priority matrix.
        settings: rank tolerance and optional damping of the layers.

    Returns:
        (k, n, n) symmetric projectors with eigenvalues in [0, 1].
    """
    settings = settings or ProjectorSettings()
    k, n = alpha.shape[0], jacobian.shape[1]
    result = np.empty((k, n, n))
    write_projectors(
        np.ascontiguousarray(jacobian, dtype=np.float64),
        np.asarray(starts, dtype=np.int64),
        np.ascontiguousarray(alpha, dtype=np.float64),
        settings.rank_tolerance,
        max(settings.layer_damping, 0.0),
        result,
    )
    return result


def smallest_singular_value(projectors: Array) -> float:
    """Smallest singular value of [P_1 .. P_k]; (13b) is solvable where it is positive.

    Args:
        projectors: (k, n, n).
    """
    gram = np.einsum("kij,klj->il", projectors, projectors)
    return float(np.sqrt(max(np.linalg.eigvalsh(gram)[0], 0.0)))
