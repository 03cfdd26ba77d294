"""Frozen values that travel through the pipeline; shapes and units stand beside the fields.

n = number of velocity coordinates, a = actuated joints, m = rows of a task.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Starts = NDArray[np.int64]  # (k + 1,) first row of each of k tasks; the last one ends the rows

NANOSECONDS = 1_000_000_000  # [ns/s] stamps are counts of nanoseconds
CONTROL_DT = 1e-3  # [s] default control period
PREVIEW_STEP = 0.01  # [s] default time between two plans of a generator
UNIT_TOLERANCE = 1e-3  # [-] a normal or quaternion this far from unit length is rejected

_NO_WRENCHES: Mapping[str, Array] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class RobotState:
    """Measured state of the robot at one instant, in the joint order of the RobotModel.

    Of a floating base q begins with position [m] and unit quaternion x, y, z, w in the world, v
    with linear [m/s] and angular velocity in base axes.
    """

    time: float  # [s]
    q: Array  # (nq,) [rad]
    v: Array  # (n,) [rad/s]
    torque: Array | None = None  # (a,) [Nm] applied over the last period; NaN: not measured
    wrenches: Mapping[str, Array] = field(default_factory=lambda: _NO_WRENCHES)
    # name -> (6,) force [N], torque [Nm] of the environment on the robot, world axes
    epoch: int = 0  # counts resets; in a simulator alone, time is 0 again after each


@dataclass(frozen=True, slots=True)
class Dynamics:
    """Equation of motion M(q) dv + h(q, v) = S^T tau + Jc^T w of eq. 1, at one state."""

    mass_matrix: Array  # (n, n) M, symmetric, C-contiguous
    bias: Array  # (n,) h: Coriolis, centrifugal and gravity terms [Nm] or [N]


@dataclass(frozen=True, slots=True)
class Bounds:
    """Lower and upper bound per entry; +-inf where there is none."""

    lower: Array  # (r,)
    upper: Array  # (r,)


class TaskTarget(NamedTuple):
    """Reference of a task at one instant; a tuple, since one that moves is made in every tick."""

    position: Array  # (m,); (4,) quaternion xyzw for an orientation, (7,) for a pose
    velocity: Array  # (m,)
    acceleration: Array  # (m,)
    wrench: Array | None = None  # (m,) [N] or [Nm] to be exerted on the environment


class TaskRows:
    """Rows of one task, or of several below each other; arrays that are written in place.

    A task measures error, Jacobian and drift. The reference gives velocity and acceleration, the
    file of the robot the gains. The law (tasks/law.py) makes the target of all of them.

    Attributes:
        jacobian: (m, n), rate of the task variable = jacobian @ v.
        error: (m,) reference - actual; [N] or [Nm] on rows under force control.
        drift: (m,) acceleration of the task variable = jacobian @ dv + drift.
        velocity, acceleration: (m,) of the reference.
        stiffness, damping: (m,) [1/s^2], [1/s].
        target: (m,) jacobian @ dv -> target: wanted acceleration minus drift.
        vectors: (7, m), the seven above in the order of VECTORS, for compiled laws.
    """

    VECTORS = ("error", "drift", "velocity", "acceleration", "stiffness", "damping", "target")
    __slots__ = (*VECTORS, "jacobian", "vectors")

    def __init__(self, jacobian: Array, vectors: Array) -> None:
        """Views of jacobian (m, n) and vectors (7, m)."""
        self.jacobian, self.vectors = jacobian, vectors
        self.error, self.drift, self.velocity, self.acceleration = vectors[:4]
        self.stiffness, self.damping, self.target = vectors[4:]

    @classmethod
    def zeros(cls, m: int, n: int) -> TaskRows:
        """m rows on n velocity coordinates."""
        return cls(np.zeros((m, n)), np.zeros((len(cls.VECTORS), m)))

    def block(self, first: int, end: int) -> TaskRows:
        """The rows from `first` to `end` - 1, on the same arrays."""
        return TaskRows(self.jacobian[first:end], self.vectors[:, first:end])
