"""One contact of the robot with its surroundings, as the robot's file describes it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from ghc_controller.contacts.sensing_settings import Sensing
from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import Follower
from ghc_controller.schema.reader import Fields
from ghc_controller.types import Array

_SURFACE_POINTS = 3  # as many points fix all six coordinates of a frame


class OnStale(Enum):
    """What holds when the plan of a contact has ended and no new one came."""

    HOLD = "hold"  # the last bounds of the plan
    RELEASE = "release"  # the bounds of the robot's file


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """A point, a line or a surface of one frame on something fixed.

    With friction and three or more points all six coordinates of the frame stay still (eq. 5.1 of
    the thesis), with fewer points those of each point; without friction only the motion along the
    normal is kept still, and only a normal force acts.
    """

    name: str  # as in contacts/<name> and in schedules
    frame_id: int
    points: Array  # (p, 3) [m] in the frame
    axes: Array  # (3, 3) rows: two tangents, then the normal; world axes
    friction: float  # [-]
    force_lower: float  # [N] normal force of all points together, without a generator
    force_upper: float  # [N]
    active: bool  # at the start
    on_stale: OnStale
    force_task: ContactForceTask | None = None
    sensing: Sensing | None = None  # None: it follows its schedule alone

    @property
    def is_surface(self) -> bool:
        """True when the frame is held as a whole."""
        return self.friction > 0.0 and self.points.shape[0] >= _SURFACE_POINTS

    @property
    def force_axes(self) -> Array:
        """Directions (a, 3) of the force at each point: all three, or the normal."""
        return self.axes if self.friction > 0.0 else self.axes[2:]

    @property
    def motion_rows(self) -> int:
        """How many accelerations it fixes."""
        return 6 if self.is_surface else self.force_axes.shape[0] * self.points.shape[0]

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Contact:
        """Build from one entry of `contacts` in robot.yaml, whose `kind` is already read.

        Raises:
            ConfigurationError: a field that is missing, unknown or out of range.
        """
        name = fields.text("name")
        frame = fields.choice("frame", model.frame_names)
        lower = fields.number("force_lower", 0.0, minimum=0.0)
        upper = fields.number("force_upper", 1000.0, minimum=0.0)
        if lower > upper:
            raise fields.error("force_lower", f"{lower:g} N given, force_upper is {upper:g} N")
        task = None
        if fields.has("force_task"):
            section = fields.section("force_task")
            task = ContactForceTask(name, section.number("weight", 1.0, minimum=0.0))
            section.done()
        sensing = None
        if fields.has("sensing"):
            sensing = Sensing.from_config(fields.section("sensing"))
        on_stale = OnStale.HOLD
        if fields.has("on_stale"):
            on_stale = OnStale(fields.choice("on_stale", [kind.value for kind in OnStale]))
        contact = cls(
            name,
            model.frame_id(frame),
            np.array(fields.vectors("points", 3)),
            contact_axes(np.array(fields.vector("normal", 3)), name),
            fields.number("friction", 0.5, minimum=0.0),
            lower,
            upper,
            fields.flag("active", False),
            on_stale,
            task,
            sensing,
        )
        fields.done()
        return contact


class ContactForceTask(Follower):
    """|F_n - F_ref|^2, beside the tasks of the hierarchy: a force that a contact shall carry.

    It has no rows on accelerations: contact forces are variables of the QP, so that its weight
    enters their cost. A reference gives `wrench` (1,), F_ref [N] as the surroundings push, and
    `position` (1,), the share of the weight, 0 to 1: a task that fades in or out (section 5.1 of
    the thesis on the approach of Salini).
    """

    def __init__(self, name: str, weight: float) -> None:
        super().__init__(name, ("normal",))
        self.weight = weight  # [-] beside the unit weight of task accelerations

    def current(self, model: RobotModel) -> Array:  # noqa: ARG002
        """Without a reference it is off: share 0."""
        return np.zeros(1)


def contact_axes(normal: Array, name: str) -> Array:
    """Rows: two tangents and the unit normal, right-handed, (3, 3).

    Raises:
        InvalidValue: the normal has no direction.
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
