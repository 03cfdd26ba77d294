"""Controller status over one run."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ghc_sim_bridge.logs.constraint_series import ConstraintTrace
from ghc_sim_bridge.logs.contact_loads import LoadTrace


@dataclass(slots=True)
class ControllerTrace:
    """Values of `controller_state` messages for k tasks, one entry per message."""

    tasks: tuple[str, ...] = ()
    time: list[float] = field(default_factory=list)  # [s] simulated
    alpha: list[list[float]] = field(default_factory=list)  # row-major (k * k)
    errors: list[list[float]] = field(default_factory=list)  # (k,) error norms [m] or [rad]
    references: list[list[list[float]]] = field(default_factory=list)  # (k, position size)
    time_terms: list[float] = field(default_factory=list)  # [s] wall
    time_solve: list[float] = field(default_factory=list)  # [s] wall
    time_step: list[float] = field(default_factory=list)  # [s] wall
    slack: dict[str, float] = field(default_factory=dict)  # row -> largest slack
    fallback_reasons: set[str] = field(default_factory=set)
    constraints: ConstraintTrace = field(default_factory=ConstraintTrace)
    loads: LoadTrace = field(default_factory=LoadTrace)
    counts: dict[str, int] = field(default_factory=dict)  # the latest ones

    def alpha_over_time(self) -> NDArray[np.float64]:
        """Priority matrices, (messages, k, k) [-]."""
        k = len(self.tasks)
        return np.array(self.alpha, dtype=np.float64).reshape(-1, k, k)
