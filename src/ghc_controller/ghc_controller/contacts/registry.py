"""Contact kinds by name."""

from __future__ import annotations

from ghc_controller.contacts.contact import Contact
from ghc_controller.errors import PluginError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.registry import Registry
from ghc_controller.schema.reader import Fields

DEFAULT_CONTACT = "rigid"

CONTACTS: Registry[type[Contact]] = Registry(
    "contact kind", "ghc_controller.contacts", modules="ghc_controller.contacts", base=Contact
)
# Class decorator: makes a Contact available as `kind` in robot.yaml.
register_contact = CONTACTS.register


def make_contact(fields: Fields, model: RobotModel) -> Contact:
    """Build a contact from one entry of `contacts` in robot.yaml.

    Raises:
        ConfigurationError: unknown kind, or a field that is missing, unknown or out of range.
    """
    kind = fields.choice("kind", CONTACTS) if fields.has("kind") else DEFAULT_CONTACT
    try:
        return CONTACTS[kind].from_config(fields, model)
    except PluginError as error:
        raise fields.error("kind", str(error)) from error
