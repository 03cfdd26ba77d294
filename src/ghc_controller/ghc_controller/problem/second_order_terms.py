"""Second-order terms of all tasks at one state, as a control problem carries them."""

from __future__ import annotations

from typing import NamedTuple

from ghc_controller.types import Array


class SecondOrder(NamedTuple):
    """k tasks with m rows in total; zero for rows under force control."""

    rows: Array  # (m, n, n) grad^2 of each task variable
    own: Array  # (k, n, n) S with grad^2 (1/2 |e|^2) = J^T J + S
    error: Array  # (m,) reference minus task variable
    rate: Array  # (k,) [1/s] kd of each task
