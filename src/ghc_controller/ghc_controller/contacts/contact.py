"""One contact of the robot with its environment, as described in robot.yaml."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import ClassVar, Self

import numpy as np

from ghc_controller.contacts.pyramid import largest_friction_use, point_cone
from ghc_controller.contacts.sensing_settings import Sensing
from ghc_controller.core import write_force_map, write_point_motion
from ghc_controller.errors import InvalidField, InvalidValue
from ghc_controller.model.frames import FrameTerms
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import Follower
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.types import Array

Vector = tuple[float, float, float]

STOPPING_RATE = 20.0  # [1/s] rate at which the motion of a sliding contact is stopped


class OnStale(Enum):
    """Bounds of a contact after the end of its last plan."""

    HOLD = "hold"  # the last bounds of the plan
    RELEASE = "release"  # the bounds of robot.yaml


@dataclass(frozen=True, slots=True)
class ForceTaskFields:
    """The section `force_task` of a contact in robot.yaml."""

    weight: float = declared(
        "with which the normal force follows a reference", 1.0, unit="-", domain=NOT_NEGATIVE
    )


@dataclass(frozen=True, slots=True)
class ContactFields:
    """One entry of `contacts` in robot.yaml."""

    name: str = declared("as in contacts/<name> and in schedules")
    frame: str = declared("frame of the URDF", names="frame")
    points: tuple[Vector, ...] = declared(
        "in the frame; with friction, three or more hold the frame as a whole", unit="m"
    )
    normal: Vector = declared("direction in which the environment pushes, world axes", unit="-")
    friction: float = declared(
        "that the QP may count on; 0 = a normal force alone", 0.5, unit="-", domain=NOT_NEGATIVE
    )
    force_lower: float = declared(
        "normal force, where no generator bounds it", 0.0, unit="N", domain=NOT_NEGATIVE
    )
    force_upper: float = declared(
        "normal force, where no generator bounds it", 1000.0, unit="N", domain=NOT_NEGATIVE
    )
    active: bool = declared("on at the start", False)
    on_stale: OnStale = declared(
        "what holds when the plan of its generator has ended: its last bounds, or those here",
        OnStale.HOLD,
    )
    force_task: ForceTaskFields | None = declared("the normal force follows a reference", None)
    sensing: Sensing | None = declared(
        "the measured wrench confirms touch-down and lift-off; left out = schedule alone", None
    )

    def __post_init__(self) -> None:
        """Raise InvalidField for a lower bound above the upper one."""
        if self.force_lower > self.force_upper:
            raise InvalidField(
                "force_lower",
                f"{self.force_lower:g} N given, force_upper is {self.force_upper:g} N",
            )


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """Points of one frame on a fixed environment: kind `point`, and base class of all others.

    A kind defines which motion is constrained (`motion_rows`, `write_motion`), where its forces
    act (`forces`, `normal`, `write_forces`), and which forces are admissible (`cone`,
    `friction_use`). Here each point is fixed along `force_axes` (eq. 5.1 of the thesis) and
    carries a force along them: all three axes with friction, else the normal only. A kind that
    differs only in its axes overrides `force_axes` and nothing else.
    """

    entry: ClassVar[type[ContactFields]] = ContactFields  # fields in robot.yaml

    name: str  # as in contacts/<name> and in schedules
    frame_id: int
    points: Array  # (p, 3) [m] in the frame
    axes: Array  # (3, 3) rows: two tangents, normal; world axes
    friction: float  # [-]
    force_lower: float  # [N] normal force of all points together, without a generator
    force_upper: float  # [N]
    active: bool  # at the start
    on_stale: OnStale
    force_task: ContactForceTask | None = None
    sensing: Sensing | None = None  # None: schedule only

    @property
    def force_axes(self) -> Array:
        """Directions (a, 3) of the force at each point, C-contiguous, the normal last."""
        return self.axes if self.friction > 0.0 else self.axes[2:]

    @property
    def motion_rows(self) -> int:
        """Number of constrained accelerations, q."""
        return self.forces

    def write_motion(self, frame: FrameTerms, jacobian: Array, target: Array) -> None:
        """Write J (q, n) and the accelerations J x (q,) that keep the contact at rest.

        Args:
            frame: the contact's frame at the last `model.update`.
        """
        write_point_motion(
            frame.rotation,
            frame.jacobian,
            frame.velocity,
            frame.drift,
            self.points,
            self.force_axes,
            STOPPING_RATE,
            target,
        )
        self.write_forces(frame, jacobian)

    @property
    def forces(self) -> int:
        """Number of force coordinates, c."""
        return self.points.shape[0] * self.force_axes.shape[0]

    @property
    def normal(self) -> Array:
        """(c,) e, with the normal force of the whole contact F_n = e^T f; entries 0 or 1."""
        e = np.zeros(self.force_axes.shape[0])
        e[-1] = 1.0
        return np.tile(e, self.points.shape[0])

    def write_forces(self, frame: FrameTerms, jacobian: Array) -> None:
        """Write J_f (c, n): forces f exert the generalized force J_f^T f."""
        write_force_map(frame.rotation, frame.jacobian, self.points, self.force_axes, jacobian)

    def cone(self) -> Array:
        """Rows (r, c) with rows f <= 0: friction pyramid and unilateral normal forces."""
        one = point_cone(self.friction, self.force_axes)
        return np.asarray(np.kron(np.eye(self.points.shape[0]), one), dtype=np.float64)

    def friction_use(self, force: Array) -> float:
        """Largest |F_t| / (mu F_n) [-] over the points, for f (c,) [N]; 0 without friction."""
        if self.friction == 0.0 or self.force_axes.shape[0] == 1:
            return 0.0
        return largest_friction_use(force.reshape(-1, 3), self.friction)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Self:
        """Build from one entry of `contacts` in robot.yaml, whose `kind` is already read.

        Raises:
            ConfigurationError: a field that is missing, unknown or out of range.
        """
        given = read(fields, cls.entry, names={"frame": model.frame_names})
        task = given.force_task
        return cls(
            given.name,
            model.frame_id(given.frame),
            np.array(given.points),
            contact_axes(np.array(given.normal), given.name),
            given.friction,
            given.force_lower,
            given.force_upper,
            given.active,
            given.on_stale,
            None if task is None else ContactForceTask(given.name, task.weight),
            given.sensing,
        )


class ContactForceTask(Follower):
    """Force task |F_n - F_ref|^2 of a contact, outside the hierarchy of motion tasks.

    It has no rows on accelerations: contact forces are QP variables, and the task enters their
    cost. A reference gives `wrench` (1,), F_ref [N] exerted by the environment, and `position`
    (1,), the fraction 0 to 1 of the weight, to fade the task in or out (thesis, section 5.1, on
    the approach of Salini).
    """

    def __init__(self, name: str, weight: float) -> None:
        super().__init__(name, ("normal",))
        self.weight = weight  # [-] relative to the unit weight of task accelerations

    def current(self, model: RobotModel) -> Array:  # noqa: ARG002
        """Without a reference the task is off: weight fraction 0."""
        return np.zeros(1)


def contact_axes(normal: Array, name: str) -> Array:
    """Rows: two tangents and the unit normal, right-handed, (3, 3).

    Raises:
        InvalidValue: the normal is zero or not finite.
    """
    length = float(np.linalg.norm(normal))
    if not length > 1e-6:
        raise InvalidValue(
            f"contact '{name}': normal {normal.tolist()} given, a direction expected"
        )
    unit = normal / length
    helper = np.eye(3)[int(np.argmin(np.abs(unit)))]
    first = np.cross(helper, unit)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(unit, first), unit])
