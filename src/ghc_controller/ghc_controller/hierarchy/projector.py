"""Generalized projectors of the GHC paper (algorithms 1 and 2); the core computes them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ghc_controller.core import native
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.types import Array, Starts


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
        """These settings, with this damping if none is set."""
        return self if self.layer_damping >= 0.0 else replace(self, layer_damping=layer_damping)


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
    damping = max(settings.layer_damping, 0.0)
    return native.generalized_projectors(jacobian, starts, alpha, settings.rank_tolerance, damping)


def smallest_singular_value(projectors: Array) -> float:
    """Smallest singular value of [P_1 .. P_k]; (13b) is solvable where it is positive.

    Args:
        projectors: (k, n, n).
    """
    gram = np.einsum("kij,klj->il", projectors, projectors)
    return float(np.sqrt(max(np.linalg.eigvalsh(gram)[0], 0.0)))
