"""Contact kinds by name."""

from __future__ import annotations

from ghc_controller.contacts.contact import Contact
from ghc_controller.contacts.sliding import SlidingContact
from ghc_controller.contacts.surface import SURFACE_POINTS, SurfaceContact
from ghc_controller.errors import PluginError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.registry import Registry
from ghc_controller.schema.reader import Fields

DEFAULT_CONTACT = "rigid"

CONTACTS: Registry[type[Contact]] = Registry(
    "contact kind", "ghc_controller.contacts", base=Contact
)
CONTACTS.register("point")(Contact)
CONTACTS.register("surface")(SurfaceContact)
CONTACTS.register("sliding")(SlidingContact)


@CONTACTS.register(DEFAULT_CONTACT)
class RigidContact(Contact):
    """A surface where it has friction and three points or more, else points."""

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Contact:  # type: ignore[override]
        """Build what it is from one entry of `contacts`."""
        made = Contact.from_config(fields, model)
        if made.friction > 0.0 and made.points.shape[0] >= SURFACE_POINTS:
            return SurfaceContact.from_config(fields, model)
        return made


def make_contact(fields: Fields, model: RobotModel) -> Contact:
    """Build the contact that one entry of `contacts` in robot.yaml describes.

    Raises:
        ConfigurationError: unknown kind, or a field that is missing, unknown or out of range.
    """
    kind = fields.choice("kind", CONTACTS) if fields.has("kind") else DEFAULT_CONTACT
    try:
        return CONTACTS[kind].from_config(fields, model)
    except PluginError as error:
        raise fields.error("kind", str(error)) from error
