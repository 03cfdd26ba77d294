"""The control problem of one tick: tasks, priorities, dynamics and limits; no solver yet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.problem.second_order_terms import SecondOrder
from ghc_controller.types import Array, Bounds, Starts


class ForceExpansion(NamedTuple):
    """Cost on the forces of all contacts: 1/2 (f - f_0)^T H_f (f - f_0)."""

    center: Array  # (c,) [N] f_0
    factor: Array  # (c, c) F with F F^T = H_f^-1


_NO_COSTS: Mapping[bytes, ForceExpansion] = {}


class ContactRows(NamedTuple):
    """Rigid contacts: J x = drift_target (thesis, eq. 5.1), with forces f acting through J_f^T.

    q = motion rows, c = force coordinates, r = rows on the forces: the first `bounds` of them are
    normal force bounds (eq. 5.5), which are relaxed before any other row of a contact, then
    friction cones (eq. 5.3). Cost on the forces: 1/2 (f - f_0)^T H_f (f - f_0), beside the tasks.
    """

    jacobian: Array  # (q, n) J
    drift_target: Array  # (q,) -dJ/dt v, and what stops a contact that slides
    force_jacobian: Array  # (c, n) J_f
    force_matrix: Array  # (r, c)
    force_lower: Array  # (r,) [N]
    force_upper: Array  # (r,) [N]
    force_center: Array  # (c,) [N] f_0
    force_factor: Array  # (c, c) F with F F^T = H_f^-1
    names: tuple[str, ...]  # (r,)
    bounds: int = 0
    forces: tuple[tuple[str, slice], ...] = ()  # names of the contacts, and their entries of f
    of_candidates: Mapping[bytes, ForceExpansion] = _NO_COSTS  # by alpha; others have the above

    def cost_of(self, alpha: Array) -> ForceExpansion:
        """Cost on the forces where a matrix (k, k) is in force."""
        shared = ForceExpansion(self.force_center, self.force_factor)
        return self.of_candidates.get(alpha.tobytes(), shared)


class AccelerationRows(NamedTuple):
    """General rows lower <= matrix x + force_matrix f <= upper, such as obstacles.

    Rows A tau of a robot in contact are rows on x and f: A (M_a x + h_a - J_fa^T f).
    """

    matrix: Array  # (r, n)
    lower: Array  # (r,)
    upper: Array  # (r,)
    names: tuple[str, ...]  # (r,)
    force_matrix: Array | None = None  # (r, c); None: no row depends on contact forces
    hard: int = 0  # the last so many are never relaxed

    @property
    def soft(self) -> int:
        """How many are relaxed with the box on accelerations; they come first."""
        return self.lower.shape[0] - self.hard

    def values(self, x: Array, force: Array) -> Array:
        """(r,) at accelerations x (n,) and contact forces (c,)."""
        reached: Array = self.matrix @ x
        return reached if self.force_matrix is None else reached + self.force_matrix @ force


@dataclass(frozen=True, slots=True)
class ControlProblem:
    """Everything that one formulation needs to find accelerations, contact forces and torques.

    n velocity coordinates, the first u of them unactuated, a = n - u joints, k tasks with m rows
    in total. Equation of motion (GHC paper, eq. 1): M x + h = [0; tau] + J_c^T f.
    """

    jacobian: Array  # (m, n) augmented Jacobian, eq. 10
    target: Array  # (m,) desired task accelerations minus drift
    starts: Starts  # (k + 1,) first row of each task
    priorities: Priorities  # of k tasks
    mass_matrix: Array  # (n, n)
    bias: Array  # (n,) Coriolis, centrifugal and gravity
    velocity: Array  # (n,) v: damping pulls accelerations to -kd v
    acceleration: Bounds  # (n,) soft box on x: position and velocity limits
    torque: Bounds  # (a,) hard box on tau: torque limits and torque rate
    torque_limit: Bounds  # (a,) the torque limits alone, kept when the rate limit is relaxed too
    rows: AccelerationRows | None = None
    contacts: ContactRows | None = None
    unactuated: int = 0
    second_order: SecondOrder | None = None  # None: the tasks are linearized

    @property
    def alpha(self) -> Array:
        """(k, k) priority matrix."""
        return self.priorities.alpha

    def of_candidate(self, index: int) -> ControlProblem:
        """The problem of one candidate of the mixture alone."""
        alpha, contacts = self.priorities.candidates[index].alpha, self.contacts
        if contacts is not None and contacts.of_candidates:
            center, factor = contacts.cost_of(alpha)
            contacts = contacts._replace(
                force_center=center, force_factor=factor, of_candidates=_NO_COSTS
            )
        return replace(self, priorities=Priorities.of(alpha), contacts=contacts)

    def own_costs(self) -> tuple[ForceExpansion, ...]:
        """Cost on contact forces of each candidate; () where all share one."""
        contacts = self.contacts
        if contacts is None or not contacts.of_candidates:
            return ()
        return tuple([contacts.cost_of(one.alpha) for one in self.priorities.candidates])

    @property
    def limits_rate(self) -> bool:
        """Whether the torque box holds more than the torque limits, which is the torque rate."""
        box, limit = self.torque, self.torque_limit
        return box is not limit and not (  # by their bytes: array_equal takes ten times as long
            box.lower.tobytes() == limit.lower.tobytes()
            and box.upper.tobytes() == limit.upper.tobytes()
        )

    def not_finite(self) -> str:
        """Name of the first part of the problem that is not finite; "" where all can be used."""
        parts = {
            "jacobian": self.jacobian,
            "target": self.target,
            "alpha": self.alpha,
            "mass_matrix": self.mass_matrix,
            "bias": self.bias,
            "velocity": self.velocity,
        }
        if self.contacts is not None:
            parts |= {
                "contact jacobian": self.contacts.jacobian,
                "contact drift_target": self.contacts.drift_target,
                "contact force_jacobian": self.contacts.force_jacobian,
                "contact force_center": self.contacts.force_center,
                "contact force_factor": self.contacts.force_factor,
            }
            for center, factor in self.contacts.of_candidates.values():
                if not math.isfinite(center.sum() + factor.sum()):
                    return "contact force cost of a candidate"
        if self.rows is not None:
            parts |= {"matrix of rows": self.rows.matrix}
            if self.rows.force_matrix is not None:
                parts |= {"force matrix of rows": self.rows.force_matrix}
            if np.isnan(self.rows.lower).any() or np.isnan(self.rows.upper).any():
                return "bound of a row"
        for name, values in parts.items():
            if not math.isfinite(values.sum()):
                return name
        return ""

    def check(self) -> None:
        """Raise WrongSize or InvalidValue where the parts do not fit together."""
        m, n = self.jacobian.shape
        k = self.starts.shape[0] - 1
        joints = n - self.unactuated
        expected = {
            "target": (self.target.shape, (m,)),
            "alpha": (self.alpha.shape, (k, k)),
            "mass_matrix": (self.mass_matrix.shape, (n, n)),
            "bias": (self.bias.shape, (n,)),
            "velocity": (self.velocity.shape, (n,)),
            "acceleration bounds": (self.acceleration.lower.shape, (n,)),
            "torque bounds": (self.torque.lower.shape, (joints,)),
            "torque limits": (self.torque_limit.lower.shape, (joints,)),
        }
        for name, (given, wanted) in expected.items():
            if given != wanted:
                raise WrongSize(f"control problem: {name}", given, wanted)
        if self.starts[-1] != m:
            raise InvalidValue(f"starts end at row {self.starts[-1]}, the Jacobian has {m} rows")
