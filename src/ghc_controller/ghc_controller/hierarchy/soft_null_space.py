"""Compiled null spaces P = I - S^T (S S^T + e^2 I)^-1 S, for the damped layers of projectors.

S stacks the rows of all levels above. With L L^T = S S^T + e^2 I and B = L^-1 S it is
P = I - B^T B, and a further level only appends rows to B. At a singularity P goes from 0 to 1
over singular values of about e instead of at once. The levels of `cascade` have theirs in the core
(`core/null_space.cpp`), which a compiled kernel of Python cannot call.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.numerics.small_factors import REORDERED_SUMS
from ghc_controller.types import Array


@njit(cache=True, fastmath=REORDERED_SUMS)
def append_rows(
    jacobian: Array, damping: float, basis: Array, used: int
) -> int:  # pragma: no cover
    """Append what the rows (m, d) of a level add to `basis` (>= used + m, d); the new `used`.

    A row longer than 1 is damped in proportion, so that rounding never outweighs the damping.
    """
    d = jacobian.shape[1]
    for r in range(jacobian.shape[0]):
        row = basis[used]
        square = 0.0
        for c in range(d):
            row[c] = jacobian[r, c]
            square += row[c] * row[c]
        pivot = damping * damping * max(1.0, square)
        for b in range(used):
            share = 0.0
            for c in range(d):
                share += jacobian[r, c] * basis[b, c]
            for c in range(d):
                row[c] -= share * basis[b, c]
        for c in range(d):
            pivot += jacobian[r, c] * row[c]
        scale = 1.0 / np.sqrt(max(pivot, damping * damping))
        for c in range(d):
            row[c] *= scale
        used += 1
    return used
