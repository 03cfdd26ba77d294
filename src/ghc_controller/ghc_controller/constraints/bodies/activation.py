"""How rows of distances come and go without a jump."""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array

ALWAYS = 0.2  # [-] of the influence distance, within which every pair has a row
_FADE = 0.25  # [-] of the influence distance over which a row comes into force
_RANK_FADE = 0.01  # [m] nearer than the first pair that is left out, over which a row does


def relaxation(room: Array, influence: float, left_out: float) -> Array:
    """(k,) [-] by how much rows are relaxed: 0 = not at all, inf = as if they were not there.

    The relaxation 1 / s - 1 falls from infinity to 0, as s goes from 0 to 1, once over the outer
    part of the influence distance, and once over the last centimeter before the first pair beyond
    the largest number of rows. So a row enters and leaves where it allows everything. The second
    one would relax all rows where more pairs are equally near, so it ends at `ALWAYS`.

    Args:
        room: (k,) [m] distances above their margins.
        influence: [m] of `room`, from which on there is no row.
        left_out: [m] `room` of the nearest pair that may get no row; inf without one.
    """
    by_distance = np.clip((influence - room) / (_FADE * influence), 0.0, 1.0)
    by_rank = np.clip((left_out - room) / _RANK_FADE, 0.0, 1.0)
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / (by_distance * by_rank) - 1.0)
