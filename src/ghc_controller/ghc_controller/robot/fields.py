"""Declared fields of robot.yaml; those of tasks and contacts are declared with each kind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ghc_controller.constraints.registry import ConstraintFields, constraint_entries
from ghc_controller.contacts.contact import ContactFields
from ghc_controller.contacts.registry import CONTACTS, DEFAULT_CONTACT
from ghc_controller.model.limits import Limit
from ghc_controller.robot.urdf import UrdfFields
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import Range
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.registry import task_entries
from ghc_controller.tasks.task import TaskFields

_NOT_ZERO = Range(minimum=1e-6)


def _urdf_schema(schema: Any) -> dict[str, Any]:
    return {"anyOf": [{"type": "string", "minLength": 1}, schema.record(UrdfFields)]}


def _positive_schema(_: Any) -> dict[str, Any]:
    """A number, or joint: number, all above zero."""
    number = {"type": "number", "exclusiveMinimum": 0.0}
    return {"anyOf": [number, {"type": "object", "additionalProperties": number}]}


def _tasks_schema(schema: Any) -> dict[str, Any]:
    """A list whose entries have the fields of their kind."""
    entry = schema.one_of_kinds("kind", task_entries(), TaskFields)
    return {"type": "array", "items": entry, "minItems": 1}


def _contacts_schema(schema: Any) -> dict[str, Any]:
    """A list whose entries may name their kind, and have the fields of that kind as well."""
    entry = schema.fields(ContactFields)
    choices = []
    for name in sorted(CONTACTS.built_in):
        if CONTACTS[name].entry is not ContactFields:
            own = schema.fields(CONTACTS[name].entry)
            entry["properties"] |= own["properties"]
            if_named = {"properties": {"kind": {"const": name}}, "required": ["kind"]}
            choices.append({"if": if_named, "then": {"required": own["required"]}})
    kind = {
        "description": "which motion is fixed, and which forces it carries",
        "enum": sorted(CONTACTS.built_in),
        "default": DEFAULT_CONTACT,
    }
    entry["properties"] = {"kind": kind} | entry["properties"]
    entry["allOf"] = choices
    return {"type": "array", "items": entry}


def _constraints_schema(schema: Any) -> dict[str, Any]:
    """A list whose entries have the fields of their kind."""
    entry = schema.one_of_kinds("kind", constraint_entries(), ConstraintFields)
    return {"type": "array", "items": entry}


def _settings_schema(schema: Any) -> dict[str, Any]:
    """The settings import robots, so robots cannot import them."""
    found: dict[str, Any] = schema.parameters_of("settings")
    return found


@dataclass(frozen=True, slots=True)
class LimitFields:
    """The section `limits` of robot.yaml."""

    velocity: Limit = declared(
        "a number, or joint: number; left out = of the URDF",
        None,
        unit="rad/s",
        schema=_positive_schema,
    )
    torque: Limit = declared(
        "a number, or joint: number; left out = of the URDF",
        None,
        unit="Nm",
        schema=_positive_schema,
    )
    torque_rate: Limit = declared(
        "largest change of torque: a number, or joint: number (others 1000); left out = 1000",
        None,
        unit="Nm/s",
        schema=_positive_schema,
    )
    brake_acceleration: float = declared(
        "deceleration before a position limit; the torque limits must allow it",
        5.0,
        unit="rad/s^2",
        domain=_NOT_ZERO,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFields:
    """Content of robot.yaml, before its URDF is read."""

    name: str = declared("name of the robot")
    urdf: Any = declared(
        "path of the URDF, relative to this file; or package, file and changes",
        read=Fields.value,
        schema=_urdf_schema,
    )
    floating_base: bool = declared("six free coordinates before the joints", False)
    limits: LimitFields = declared("override the URDF", LimitFields)
    tasks: tuple[Fields, ...] = declared(
        "in the order of rows and columns of alpha",
        later=TaskFields,
        schema=_tasks_schema,
    )
    hierarchy: str = declared("priorities at the start, such as 'hand > posture'")
    contacts: tuple[Fields, ...] = declared(
        "with a rigid environment", (), later=ContactFields, schema=_contacts_schema
    )
    constraints: tuple[Fields, ...] = declared(
        "in addition to the limits of joints and torques",
        (),
        later=ConstraintFields,
        schema=_constraints_schema,
    )
    settings: Fields | None = declared(
        "of the controller for this robot, by parameter name",
        None,
        later=dict,
        schema=_settings_schema,
    )
