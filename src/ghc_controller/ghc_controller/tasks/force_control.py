"""Force control of some rows of a position task (eq. 3 and section 6.2 of ghc_2015)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numba
import numpy as np

from ghc_controller.config import Fields
from ghc_controller.errors import InvalidValue
from ghc_controller.robot_model import RobotModel
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget

WORLD_AXES = ("x", "y", "z")
_MAX_STEP = 0.02  # [s] a longer gap between two states counts as this much integration time


@dataclass(slots=True)
class ForceState:
    """Memory of force control: cleared by ForceControl.reset and on every loss of contact."""

    active: bool = False
    time: float = 0.0  # [s] state that was answered last
    integral: Array | None = None  # (m,) [N s] of f_ref - f_meas


class ForceControl:
    """Decides when the chosen rows follow a force, and turns that force into accelerations.

    With f_ref = target.wrench, the force to be exerted on the surroundings, and f_meas = minus
    the measured wrench (that of the surroundings on the robot),

        w_d = f_ref + proportional (f_ref - f_meas) + integral * int (f_ref - f_meas) dt

    on the force rows and zero on the others, and eq. 3 gives xi''_d = Lambda^-1 w_d with
    Lambda^-1 = J M^-1 J^T over all rows of the task. The term is added to the motion rows as
    well, not to the force rows alone: the contact force acts on the arm with -Lambda^-1 w_d in
    every row that the inertia couples to the normal, which the computed torque does not know of.
    Adding Lambda^-1 w_d everywhere cancels it, so that holding a force on a frictionless plane
    leaves no steady position error along the plane.

    The rows turn to force control when the target has a wrench and the force measured along
    them exceeds `threshold`, and back to motion control when it falls below `release`, the
    target loses its wrench, or the contact is no longer measured. The integral grows in contact
    only and its share of w_d stays within |f_ref| (or `threshold`, if larger): no wind-up.

    The force loop is stable with 0 <= proportional < 1 and integral well below 1/dt: in contact
    f_meas follows w_d within a control period.
    """

    def __init__(
        self,
        frame_id: int,
        axes: Sequence[str],
        force_axes: Sequence[str],
        contact: str,
        threshold: float = 1.0,
        release: float = 0.2,
        proportional: float = 0.0,
        integral: float = 0.0,
        damping: float = 0.0,
    ) -> None:
        """Choose the force rows among the rows of a position task.

        Args:
            frame_id: frame of the task, as from RobotModel.frame_id.
            axes: world axis of each row of the task.
            force_axes: the axes among them that follow the force.
            contact: name of the measured wrench in RobotState.wrenches.
            threshold, release: [N] norm of the measured force along the force rows.
            proportional: [-]; integral: [1/s].
            damping: [1/s] acceleration against the frame's velocity along the force rows; zero at
                rest, so that the force is not biased.

        Raises:
            InvalidValue: a force axis is no row of the task, a gain is negative or not finite,
                or release > threshold.
        """
        for axis in force_axes:
            if axis not in axes:
                raise InvalidValue(f"force axis '{axis}' given; rows of the task: {tuple(axes)}")
        gains = (threshold, release, proportional, integral, damping)
        if not all(np.isfinite(gain) and gain >= 0.0 for gain in gains):
            raise InvalidValue(f"force control: gains {gains} given, numbers >= 0 expected")
        if release > threshold:
            raise InvalidValue(
                f"force control: release {release} N given, at most threshold {threshold} N"
                " expected"
            )
        self._frame_id = frame_id
        self._axes = np.array([WORLD_AXES.index(axis) for axis in axes])
        self.contact = contact
        self.threshold = threshold
        self.release = release
        self.proportional = proportional
        self.integral = integral
        self.damping = damping
        self.force_rows = np.array([axis in force_axes for axis in axes])
        self.state = ForceState()

    @classmethod
    def from_config(cls, fields: Fields, frame_id: int, axes: Sequence[str]) -> ForceControl:
        """Build from the `force` section of a task in robot.yaml."""
        force_axes = fields.names("axes", axes)
        contact = fields.text("contact")
        threshold = fields.number("threshold", 1.0, minimum=0.0)
        release = fields.number("release", 0.2 * threshold, minimum=0.0)
        if release > threshold:
            raise fields.error(
                "release", f"{release} given, at most threshold {threshold} expected"
            )
        control = cls(
            frame_id,
            axes,
            force_axes,
            contact,
            threshold,
            release,
            fields.number("proportional", 0.0, minimum=0.0),
            fields.number("integral", 0.0, minimum=0.0),
            fields.number("damping", 0.0, minimum=0.0),
        )
        fields.done()
        return control

    def reset(self) -> None:
        """Back to motion control with a zero integral."""
        self.state = ForceState()

    def apply(
        self,
        model: RobotModel,
        state: RobotState,
        target: TaskTarget,
        out: TaskRows,
    ) -> int:
        """Change motion rows in `out` into hybrid rows while in contact.

        Args:
            model: updated with `state`.
            state: its time and the wrench of the contact count here.
            target: reference at this instant.
            out: motion rows already written; force rows get the error f_ref - f_meas [N].

        Returns:
            Number of rows under force control now.
        """
        wrench = state.wrenches.get(self.contact)
        if target.wrench is None or wrench is None:
            self.reset()
            return 0
        force_error = target.wrench + wrench[self._axes]
        force_error[~self.force_rows] = 0.0
        normal_force = float(np.linalg.norm(wrench[self._axes[self.force_rows]]))
        if not self._in_contact(normal_force):
            self.reset()
            return 0
        wrench_d = self._desired_wrench(state.time, target.wrench, force_error)
        _hybrid_rows(
            self.force_rows,
            self._axes,
            force_error,
            wrench_d,
            model.frame_drift(self._frame_id),
            model.frame_velocity(self._frame_id),
            self.damping,
            model.dynamics.mass_matrix,
            out.jacobian,
            out.target,
            out.error,
        )
        return int(self.force_rows.sum())

    def _in_contact(self, normal_force: float) -> bool:
        if self.state.active:
            return normal_force >= self.release
        return normal_force > self.threshold

    def _desired_wrench(self, time: float, reference: Array, force_error: Array) -> Array:
        memory = self.state
        if not memory.active or memory.integral is None:
            memory.integral = np.zeros(force_error.shape)
        else:
            # A repeated state has the same time: no step, and the same answer.
            step = min(max(time - memory.time, 0.0), _MAX_STEP)
            memory.integral += step * force_error
        memory.active, memory.time = True, time
        wrench = reference + self.proportional * force_error
        if self.integral > 0.0:
            largest = np.maximum(np.abs(reference), self.threshold) / self.integral
            np.clip(memory.integral, -largest, largest, out=memory.integral)
            wrench += self.integral * memory.integral
        wrench[~self.force_rows] = 0.0
        return wrench


@numba.njit(cache=True)
def _hybrid_rows(
    force_rows: Array,
    axes: Array,
    force_error: Array,
    wrench: Array,
    drift: Array,
    velocity: Array,
    damping: float,
    mass_matrix: Array,
    jacobian: Array,
    target_out: Array,
    error_out: Array,
) -> None:
    """Mask the motion law on force rows, then add J M^-1 J^T w to every row (eq. 3)."""
    n = mass_matrix.shape[0]
    factor = np.empty((n, n))  # lower Cholesky factor of M
    push = np.zeros(n)  # J^T w, then M^-1 J^T w
    for i in range(wrench.shape[0]):
        if force_rows[i]:
            error_out[i] = force_error[i]
            target_out[i] = -drift[axes[i]] - damping * velocity[axes[i]]
            for j in range(n):
                push[j] += jacobian[i, j] * wrench[i]
    for i in range(n):
        for j in range(i + 1):
            value = mass_matrix[i, j]
            for k in range(j):
                value -= factor[i, k] * factor[j, k]
            factor[i, j] = np.sqrt(value) if i == j else value / factor[j, j]
        for k in range(i):
            push[i] -= factor[i, k] * push[k]
        push[i] /= factor[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            push[i] -= factor[k, i] * push[k]
        push[i] /= factor[i, i]
    for i in range(wrench.shape[0]):
        for j in range(n):
            target_out[i] += jacobian[i, j] * push[j]
