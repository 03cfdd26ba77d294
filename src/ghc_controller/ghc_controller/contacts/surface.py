"""A surface contact: all six coordinates of the frame are fixed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from ghc_controller.contacts.contact import STOPPING_RATE, Contact
from ghc_controller.contacts.registry import register_contact
from ghc_controller.errors import InvalidValue
from ghc_controller.model.frames import FrameTerms
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.reader import Fields
from ghc_controller.types import Array

SURFACE_POINTS = 3  # points needed to fix all six coordinates of a frame


@register_contact("surface")
@dataclass(frozen=True, slots=True, eq=False)
class SurfaceContact(Contact):
    """Fixes all six coordinates of the frame (thesis, eq. 5.1), with forces at its points."""

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Self:
        """Build from one entry of `contacts`; InvalidValue for too few points or no friction."""
        made = super(SurfaceContact, cls).from_config(fields, model)
        if made.points.shape[0] < SURFACE_POINTS or made.friction == 0.0:
            raise InvalidValue(
                f"a surface with {made.points.shape[0]} points and friction {made.friction:g} "
                f"given, {SURFACE_POINTS} or more points and friction expected"
            )
        return made

    @property
    def motion_rows(self) -> int:
        """Six."""
        return 6

    def write_motion(self, frame: FrameTerms, jacobian: Array, target: Array) -> None:
        """The frame's own Jacobian."""
        jacobian[:] = frame.jacobian
        target[:] = -frame.drift - STOPPING_RATE * frame.velocity
