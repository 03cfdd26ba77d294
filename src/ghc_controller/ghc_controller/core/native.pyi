"""The extension that CMakeLists.txt builds; the headers beside it say what each part does.

n accelerations, d reduced ones, a joints, c contact forces, m rows of tasks. Arrays are float64
and C-contiguous; others are copied. ValueError: sizes that do not fit together.
"""

from collections.abc import Sequence

from ghc_controller.types import Array

class NullSpace:
    """P = I - S^T (S S^T + e^2 I)^-1 S of rows S that are appended level by level."""

    def __init__(self, d: int, capacity: int) -> None: ...
    def append(self, rows: Array, e: float) -> None:
        """Append rows (m, d)."""

    def projector(self) -> Array:
        """P (d, d)."""

class Cascade:
    """Workspace and active sets of one order."""

    def __init__(self, rows: Sequence[int], ends: Sequence[int]) -> None:
        """Rows (m,) of the augmented Jacobian in the order of the levels; l ends at ends[l]."""

    def solve(
        self, *terms: Array | float | None
    ) -> tuple[int, int, int, float, Array, Array, Array]:
        """Answer levels from y (d,) on; None stands for an array without entries.

        Args:
            terms: jacobian (m, d), target (m,), y (d,), then what `core_terms` of the cascade
                lists, then w, e, whether levels that meet a bound are solved too (else they are
                left to the caller), and the most pivots of a level and of all.

        Returns:
            Levels that have an answer, pivots, levels that met a bound, largest violation, and of
            the last answered level x (n,), torques (a,) and forces (c,); None where none is.
        """

    def forget(self) -> None:
        """Forget the active sets."""

def level_optimum(
    jacobian: Array, target: Array, y: Array, above: NullSpace, w: float, /
) -> tuple[Array, Array, float]:
    """c = y + P A^T (A A^T + w_l I)^-1 (b - J y), (d,), A = J P (m, d) and the damping w_l."""

def level_damping(jacobian: Array, rows: Array, residual: Array, w: float, /) -> float:
    """Damping w_l of rows J (m, d), of what the levels above leave, A (m, d), and r (m,)."""
