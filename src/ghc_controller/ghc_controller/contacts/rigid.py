"""The default contact kind: surface or point, by its friction and number of points."""

from __future__ import annotations

from ghc_controller.contacts.contact import Contact
from ghc_controller.contacts.registry import DEFAULT_CONTACT, register_contact
from ghc_controller.contacts.surface import SURFACE_POINTS, SurfaceContact
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.reader import Fields

register_contact("point")(Contact)


@register_contact(DEFAULT_CONTACT)
class RigidContact(Contact):
    """A surface contact if it has friction and at least three points, else a point contact."""

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Contact:  # type: ignore[override]
        """Build a surface or point contact from one entry of `contacts`."""
        made = Contact.from_config(fields, model)
        if made.friction > 0.0 and made.points.shape[0] >= SURFACE_POINTS:
            return SurfaceContact.from_config(fields, model)
        return made
