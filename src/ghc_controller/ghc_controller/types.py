"""Frozen values that travel through the pipeline; shapes and units stand beside the fields.

n = number of velocity coordinates, a = actuated joints, m = rows of a task.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NANOSECONDS = 1_000_000_000  # [ns/s] stamps are counts of nanoseconds
CONTROL_DT = 1e-3  # [s] control period where nothing else is said
PREVIEW_STEP = 0.01  # [s] between two plans of a generator where nothing else is said
UNIT_TOLERANCE = 1e-3  # [-] a normal or quaternion this far from unit length is refused

_NO_WRENCHES: Mapping[str, Array] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class RobotState:
    """Measured state of the robot at one instant, in the joint order of the RobotModel."""

    time: float  # [s]
    q: Array  # (nq,) [rad]
    v: Array  # (n,) [rad/s]
    torque: Array | None = None  # (a,) [Nm] torque applied over the last control period
    wrenches: Mapping[str, Array] = field(default_factory=lambda: _NO_WRENCHES)
    # name -> (6,) force [N], torque [Nm] of the surroundings on the robot, world axes
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


@dataclass(frozen=True, slots=True)
class TaskTarget:
    """Reference of a task at one instant."""

    position: Array  # (m,); (4,) quaternion xyzw for an orientation, (7,) for a pose
    velocity: Array  # (m,)
    acceleration: Array  # (m,)
    wrench: Array | None = None  # (m,) [N] or [Nm] to be exerted on the surroundings


@dataclass(frozen=True, slots=True)
class TaskRows:
    """One task linearised at the current state: jacobian @ x -> target."""

    jacobian: Array  # (m, n)
    target: Array  # (m,) desired task acceleration minus drift
    error: Array  # (m,) reference - actual; [N] or [Nm] on rows under force control
    force_rows: int = 0  # how many rows are under force control
