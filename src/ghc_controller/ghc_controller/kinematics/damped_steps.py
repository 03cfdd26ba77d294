"""Adaptively damped least squares (Chiaverini 1997) for a hierarchy of equalities: `adls`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.kinematics.level_kernels import null_space_of
from ghc_controller.kinematics.level_rows import LevelRows
from ghc_controller.kinematics.settings import KinematicSettings
from ghc_controller.types import Array


def adaptive_damping_step(levels: Sequence[LevelRows], settings: KinematicSettings) -> Array:
    """dq (n,): each level in the null space of those above, damped by

    lambda^2 (1 - (s / s_0)^2) where its smallest singular value s there is below s_0.
    """
    n = levels[0].jacobian.shape[1]
    x, null_space = np.zeros(n), np.eye(n)
    for level in levels:
        if not null_space.shape[1]:
            break
        x = _damped(
            level.jacobian,
            level.lower,
            x,
            null_space,
            settings.damping**2,
            settings.small_singular_value,
        )
        null_space = null_space_of(level.jacobian, null_space, settings.rank_tolerance)
    return x


def _damped(
    rows: Array, right: Array, x: Array, null_space: Array, damping: float, small: float
) -> Array:
    U, s, Vt = np.linalg.svd(rows @ null_space, full_matrices=False)
    least = s[-1]
    weight = damping * (1.0 - (least / small) ** 2) if least < small else 0.0
    size = s * s + weight
    seen = size > 1e-20
    along = np.where(seen, U.T @ (right - rows @ x) * s / np.where(seen, size, 1.0), 0.0)
    return np.asarray(x + null_space @ (Vt.T @ along))
