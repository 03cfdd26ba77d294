"""Force control of some rows of a position task (eq. 3 and section 6.2 of ghc_2015)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.core import native
from ghc_controller.errors import InvalidField, InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.memory import TaskMemory
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget

WORLD_AXES = ("x", "y", "z")
RELEASE_SHARE = 0.2  # [-] of the threshold, below which force control ends
_MAX_STEP = 0.02  # [s] a longer gap between two states counts as this much integration time


@dataclass(frozen=True, slots=True)
class ForceFields:
    """The section `force` of a task in robot.yaml."""

    axes: tuple[str, ...] = declared(
        "axes of the task that are under force control", names="axis", empty=False
    )
    contact: str = declared("contact of the scene whose wrench is measured")
    threshold: float = declared(
        "along these axes, above which force control begins", 1.0, unit="N", domain=NOT_NEGATIVE
    )
    release: float | None = declared(
        f"below which it ends; left out = {RELEASE_SHARE} threshold",
        None,
        unit="N",
        domain=NOT_NEGATIVE,
    )
    proportional: float = declared(
        "gain on the force error, below 1", 0.0, unit="-", domain=NOT_NEGATIVE
    )
    integral: float = declared(
        "gain on its integral, well below 1 / control_dt", 0.0, unit="1/s", domain=NOT_NEGATIVE
    )
    damping: float = declared(
        "against the frame's velocity along these axes", 0.0, unit="1/s", domain=NOT_NEGATIVE
    )
    rise_time: float = declared(
        "over which the desired force rises after touch-down", 0.1, unit="s", domain=NOT_NEGATIVE
    )

    def __post_init__(self) -> None:
        """Raise InvalidValue for a number out of range, or release above threshold."""
        check(self)
        if self.ends_below > self.threshold:
            raise InvalidField(
                "release", f"{self.ends_below} given, at most threshold {self.threshold} expected"
            )

    @property
    def ends_below(self) -> float:
        """Force at which force control ends [N]."""
        return RELEASE_SHARE * self.threshold if self.release is None else self.release


class ForceControl:
    """Decides when the chosen rows follow a force, and turns that force into rows and torque.

    With f_ref = target.wrench, the force to be exerted on the surroundings, and f_meas = minus
    the measured wrench (that of the surroundings on the robot),

        w_d = f_ref + proportional (f_ref - f_meas) + integral * int (f_ref - f_meas) dt

    on the force rows and zero on the others; f_ref rises from zero to target.wrench within
    `rise_time` from the touch on, so that the torque does not jump. Eq. 3 asks for the
    acceleration xi''_d = Lambda^-1 w_d, Lambda^-1 = J M^-1 J^T. It enters all rows of the task,
    the motion rows as well: the surroundings answer with -w_d, which accelerates every row by
    -Lambda^-1 w_d,
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
    them exceeds `threshold`, and back to motion control when it falls below `release`
    (not during the rise), the target loses its wrench, or the contact is no longer measured. The
    integral grows in contact only and its share of w_d stays within |f_ref| (or `threshold`, if
    larger): no wind-up.

    The force loop is stable with 0 <= proportional < 1 and integral well below 1/dt: in contact
    f_meas follows w_d within a control period.
    """

    def __init__(
        self,
        frame_id: int,
        axes: Sequence[str],
        settings: ForceFields,
    ) -> None:
        """Choose the force rows among the rows of a position task.

        Args:
            frame_id: frame of the task, as from RobotModel.frame_id.
            axes: world axis of each row of the task.
            settings: the axes among them that follow the force, contact, thresholds and gains.

        Raises:
            InvalidValue: a force axis is no row of the task.
        """
        for axis in settings.axes:
            if axis not in axes:
                raise InvalidValue(f"force axis '{axis}' given; rows of the task: {tuple(axes)}")
        self._frame_id = frame_id
        self._axes = np.array([WORLD_AXES.index(axis) for axis in axes])
        self.contact = settings.contact
        self.threshold = settings.threshold
        self.release = settings.ends_below
        self.rise_time = settings.rise_time
        self.force_rows = np.array([axis in settings.axes for axis in axes])
        self._force_axes = self._axes[self.force_rows]
        self._gains = (
            settings.proportional,
            settings.integral,
            settings.damping,
            settings.threshold,
        )

    @classmethod
    def from_config(cls, fields: Fields, frame_id: int, axes: Sequence[str]) -> ForceControl:
        """Build from the `force` section of a task in robot.yaml."""
        return cls(frame_id, axes, read(fields, ForceFields, names={"axis": axes}))

    def make_memory(self) -> ForceMemory:
        """Memory of one follower of the task: out of contact, with a zero integral."""
        return ForceMemory(self)

    def normal_force(self, wrench: Array) -> float:
        """Size of the force along the force axes [N]; wrench (6,)."""
        return math.sqrt(sum(float(wrench[axis]) ** 2 for axis in self._force_axes))

    def ends(self, force: float, elapsed: float) -> bool:
        """Whether contact is lost at `force` [N], `elapsed` [s] after it began."""
        return elapsed >= self.rise_time and force < self.release  # while it rises little is felt

    def share(self, elapsed: float) -> float:
        """How much of the reference is commanded, 0 at the touch and 1 after the rise time."""
        if elapsed >= self.rise_time:
            return 1.0
        return 0.5 - 0.5 * math.cos(math.pi * elapsed / self.rise_time)

    def exert(
        self,
        model: RobotModel,
        share: float,
        step: float,
        reference: Array,
        wrench: Array,
        integral: Array,
        rows: TaskRows,
    ) -> int:
        """Keep the force rows still and exert w_d; number of force rows.

        Args:
            reference: (m,) [N]; `share` of it is commanded.
            wrench: (6,) measured. step: [s] by which `integral` (m,) [N s] is advanced.
            rows: just measured; force rows get the error f_ref - f_meas [N].
        """
        wanted = native.follow_force(
            self.force_rows,
            self._axes,
            step,
            share,
            reference,
            wrench,
            self._gains,
            integral,
            rows.error,
            rows.velocity,
            rows.acceleration,
            rows.stiffness,
            rows.damping,
        )
        model.exert(f"{self.contact} {self._frame_id}", rows.jacobian, wanted)
        return len(self._force_axes)


class ForceMemory(TaskMemory):
    """Whether the task is in contact, since when, and the integral of the force error."""

    def __init__(self, control: ForceControl) -> None:
        self._control = control
        self.reset()

    def reset(self) -> None:
        """Back to motion control with a zero integral."""
        self._integral = np.zeros(len(self._control.force_rows))  # [N s] of f_ref - f_meas
        self._active = False
        self._time = 0.0  # [s] state that was answered last
        self._begin = 0.0  # [s] first state in contact

    def apply(
        self, model: RobotModel, state: RobotState, reference: TaskTarget, rows: TaskRows
    ) -> int:
        """Change motion rows into hybrid rows and exert the force, while in contact."""
        control, wrench = self._control, state.wrenches.get(self._control.contact)
        if reference.wrench is None or wrench is None:
            self._leave()
            return 0
        if not self._in_contact(control.normal_force(wrench), state.time):
            self._leave()
            return 0
        step = self._step(state.time)
        share = control.share(state.time - self._begin)
        return control.exert(model, share, step, reference.wrench, wrench, self._integral, rows)

    def _leave(self) -> None:
        if self._active:
            self.reset()

    def _in_contact(self, force: float, time: float) -> bool:
        if self._active:
            return not self._control.ends(force, time - self._begin)
        return force > self._control.threshold

    def _step(self, time: float) -> float:
        """Integration time since the last state; zero for a repeated one: the same answer."""
        step = min(max(time - self._time, 0.0), _MAX_STEP) if self._active else 0.0
        if not self._active:
            self._begin = time
        self._active, self._time = True, time
        return step
