"""Record of a step, used by the next one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class StepRecord:
    """Linearization, solution and active set of one step; p levels with m_l rows."""

    step: Array  # (n,) dq
    jacobians: tuple[Array, ...]  # (m_l, n) each
    residuals: tuple[Array, ...]  # (m_l,) w: J dq - e, or the excess beyond a bound
    active: tuple[NDArray[np.bool_], ...]  # (m_l,) rows that hold as equalities
    active_changed: tuple[bool, ...]  # since the previous step
    multipliers: dict[tuple[int, int], Array]  # (level i, level l) -> lambda_{i,l} (m_i,)
    unsolved: int = 0  # levels whose QP was not solved
