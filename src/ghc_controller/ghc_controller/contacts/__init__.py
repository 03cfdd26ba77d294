"""Contacts: what stays still, which forces it may carry, and the bounds that generators plan."""

from ghc_controller.contacts.bounds_in_force import BoundsInForce, NormalBounds
from ghc_controller.contacts.bounds_plan import ForceBoundsPlan, PlanStatus
from ghc_controller.contacts.contact import Contact, ContactForceTask, OnStale
from ghc_controller.contacts.contact_set import ContactSet
from ghc_controller.contacts.force_cost import ForceCost
from ghc_controller.contacts.sensing import ContactSensing, Sensing
from ghc_controller.contacts.settling import solve_settled

__all__ = [
    "BoundsInForce",
    "Contact",
    "ContactForceTask",
    "ContactSensing",
    "ContactSet",
    "ForceBoundsPlan",
    "ForceCost",
    "NormalBounds",
    "OnStale",
    "PlanStatus",
    "Sensing",
    "solve_settled",
]
