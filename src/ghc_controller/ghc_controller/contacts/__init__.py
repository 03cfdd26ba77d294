"""Contacts: motion constraints, admissible forces, and bounds from generators."""

from ghc_controller.contacts.bounds_in_force import BoundsInForce
from ghc_controller.contacts.contact import Contact, ContactForceTask, OnStale
from ghc_controller.contacts.contact_set import ContactSet
from ghc_controller.contacts.force_constraints import FrictionCone, NormalForce
from ghc_controller.contacts.force_cost import ForceCost
from ghc_controller.contacts.normal_bounds import NormalBounds
from ghc_controller.contacts.rigid import RigidContact
from ghc_controller.contacts.rolling import RollingContact
from ghc_controller.contacts.sensing import ContactSensing
from ghc_controller.contacts.sensing_settings import Sensing
from ghc_controller.contacts.settling import solve_settled
from ghc_controller.contacts.sliding import SlidingContact
from ghc_controller.contacts.surface import SurfaceContact

__all__ = [
    "BoundsInForce",
    "Contact",
    "ContactForceTask",
    "ContactSensing",
    "ContactSet",
    "ForceCost",
    "FrictionCone",
    "NormalBounds",
    "NormalForce",
    "OnStale",
    "RigidContact",
    "RollingContact",
    "Sensing",
    "SlidingContact",
    "SurfaceContact",
    "solve_settled",
]
