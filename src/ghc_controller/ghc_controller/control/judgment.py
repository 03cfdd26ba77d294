"""What transitions and changes of the formulation must keep, where the robot is."""

from __future__ import annotations

import numpy as np

from ghc_controller.formulations import Formulation
from ghc_controller.hierarchy import (
    Solvability,
    generalized_projectors,
    smallest_singular_value,
)
from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.problem.reduction import kept_by_contacts
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array


class Judgment:
    """The part of `Controller` that judges matrices at the state last looked at."""

    stack: TaskStack
    formulation: Formulation
    _contact_rows_seen: ContactRows | None  # of the last state looked at

    def sigma_min_of(self, alpha: Array) -> float:
        """Smallest singular value of [P_1 .. P_k] at the present configuration."""
        return smallest_singular_value(
            generalized_projectors(
                self.stack.jacobian, self.stack.starts, np.array(alpha), self.formulation.projector
            )
        )

    def solvability(self) -> Solvability:
        """What transitions must keep, in the configuration and contacts last looked at."""
        return self.judge(self.formulation)

    def judge(self, formulation: Formulation) -> Solvability:
        """What transitions must keep under a formulation, where `solvability` looks."""
        jacobian, contacts = self.stack.jacobian, self._contact_rows_seen
        if contacts is not None:
            jacobian = kept_by_contacts(jacobian, contacts.jacobian)
        return formulation.solvability(jacobian, self.stack.starts)
