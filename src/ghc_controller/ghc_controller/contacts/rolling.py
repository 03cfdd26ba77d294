"""A rolling contact: balls or upright wheels that roll on a plane without slipping."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from ghc_controller.contacts.contact import STOPPING_RATE, Contact, ContactFields
from ghc_controller.contacts.registry import register_contact
from ghc_controller.core import write_force_map
from ghc_controller.errors import InvalidValue
from ghc_controller.model.frames import FrameTerms
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class RollingFields(ContactFields):
    """Fields of the kind `rolling`: `points` are the centers of the balls."""

    radius: float = declared("of the ball at each point", unit="m", domain=POSITIVE)


@register_contact("rolling")
@dataclass(frozen=True, slots=True, eq=False)
class RollingContact(Contact):
    """The material of a ball that touches the plane now has no velocity.

    With the center c of a ball, its radius r, the normal n and the angular velocity w,
        v = c' - w x r n = 0,    v' = c'' - w' x r n = 0:
    unlike a point of the frame, the place that touches is below the center at all times, so that
    v' has no centripetal term of -r n. Forces act there, within the friction pyramid. An upright
    wheel is the same, as long as its axle stays parallel to the plane.
    """

    radius: float = 0.0  # [m]

    entry = RollingFields

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Self:
        """Build from one entry of `contacts`; InvalidValue without friction."""
        made = super(RollingContact, cls).from_config(fields, model)
        if made.friction == 0.0:
            raise InvalidValue("friction 0 given, above 0 expected: it is what lets a ball roll")
        return replace(made, radius=fields.number("radius"))

    def write_forces(self, frame: FrameTerms, jacobian: Array) -> None:
        """Forces at the places that touch."""
        below = self.radius * self.axes[2] @ frame.rotation  # r n in the frame
        write_force_map(
            frame.rotation, frame.jacobian, self.points - below, self.force_axes, jacobian
        )

    def write_motion(self, frame: FrameTerms, jacobian: Array, target: Array) -> None:
        """v' = -20 v: what slips is brought to rest."""
        self.write_forces(frame, jacobian)
        spin, turn = frame.velocity[3:], frame.drift[3:]
        to_center = self.points @ frame.rotation.T
        to_plane = to_center - self.radius * self.axes[2]
        velocity = frame.velocity[:3] + np.cross(spin, to_plane)
        drift = frame.drift[:3] + np.cross(turn, to_plane)
        drift += np.cross(spin, np.cross(spin, to_center))
        target[:] = ((-drift - STOPPING_RATE * velocity) @ self.force_axes.T).ravel()
