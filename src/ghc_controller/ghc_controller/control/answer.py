"""What a state is answered with, before the gate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ghc_controller.hierarchy import TransitionEvent
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.problem.solution import Solution
from ghc_controller.report.reporting import Limits
from ghc_controller.types import Array


class Answer(NamedTuple):
    """The solution of one step and what bounded it."""

    events: Sequence[TransitionEvent]
    before: Array  # (a,) [Nm] torque from which the rate limit counts
    limits: Limits
    priorities: Priorities | None  # None: those in force, which are made where they are asked for
    solution: Solution
    torque: Array | None  # (a,) [Nm] where it went through the gate unchanged
    time_terms: float  # [s] model terms, task rows and bounds
    time_solve: float  # [s]
