"""Force control of some rows of a position task (eq. 3 and section 6.2 of ghc_2015)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
    """Decides when the chosen rows follow a force, and turns that force into rows and torque.

    With f_ref = target.wrench, the force to be exerted on the surroundings, and f_meas = minus
    the measured wrench (that of the surroundings on the robot),

        w_d = f_ref + proportional (f_ref - f_meas) + integral * int (f_ref - f_meas) dt

    on the force rows and zero on the others. Eq. 3 asks for the acceleration
    xi''_d = Lambda^-1 w_d, Lambda^-1 = J M^-1 J^T. It enters all rows of the task, the motion
    rows as well: the surroundings answer with -w_d, which accelerates every row by -Lambda^-1 w_d,
    and only the sum of both leaves the motion rows to their own law, without a steady error
    along a frictionless plane.

    The same holds beyond the task. The answer of the surroundings accelerates the joints by
    -M^-1 J^T w_d, also in the null space of J, where rows J dv -> Lambda^-1 w_d alone leave it
    uncompensated (hundreds of rad/s^2 on a light wrist: the arm folds within half a second).
    Eq. 3 is therefore met by a torque J^T w_d (RobotModel.exert), which is Lambda^-1 w_d in the
    rows of this task, M^-1 J^T w_d in every joint, and cancels the answer in all of them. What
    is left for the force rows is not to move: J dv -> -J' v - damping xi'. Lower and higher tasks
    are then not disturbed by a force that is reached.

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
        """Change motion rows in `out` into hybrid rows and exert the force, while in contact.

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
        frame, rows = model.frame(self._frame_id), self.force_rows
        out.error[rows] = force_error[rows]
        still = -frame.drift[self._axes] - self.damping * frame.velocity[self._axes]
        out.target[rows] = still[rows]
        model.exert(f"{self.contact} {self._frame_id}", out.jacobian, wrench_d)
        return int(rows.sum())

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
