"""Constraint kinds by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from ghc_controller.constraints.constraint import Constraint
from ghc_controller.errors import InvalidValue, PluginError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.registry import Registry
from ghc_controller.schema.declared import declared
from ghc_controller.schema.reader import Fields


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstraintFields:
    """What robot.yaml says of a constraint of any kind; each kind adds its own."""

    name: str = declared("as in active_constraints and slack_names")


# A class with `entry` and `from_config`, which is a `kind` of robot.yaml, or a function
# (robot, settings) that returns a constraint or None, which the settings switch on by its name.
CONSTRAINTS: Registry[Callable[..., Any]] = Registry(
    "constraint", "ghc_controller.constraints", modules="ghc_controller.constraints"
)
register_constraint = CONSTRAINTS.register


def is_kind(made_by: object) -> bool:
    """Whether what is registered is a kind of robot.yaml."""
    return isinstance(made_by, type) and issubclass(made_by, Constraint)


def constraint_entries() -> dict[str, type[ConstraintFields]]:
    """Kind -> declared fields of its entry, sorted; built-in kinds alone, as schemas have them."""
    found = {kind: CONSTRAINTS[kind] for kind in sorted(CONSTRAINTS.built_in)}
    return {kind: one.entry for kind, one in found.items() if is_kind(one)}  # type: ignore[attr-defined]


def make_constraint(fields: Fields, model: RobotModel) -> Constraint:
    """Build the constraint that one entry of `constraints` in robot.yaml describes.

    Raises:
        ConfigurationError: unknown kind, or a field that is missing, unknown or out of range.
    """
    kind = fields.choice("kind", CONSTRAINTS)
    try:
        made_by = CONSTRAINTS[kind]
        if not is_kind(made_by):
            raise fields.error("kind", f"'{kind}' has no fields: it is switched on by settings")
        made: Constraint = made_by.from_config(fields, model)  # type: ignore[attr-defined]
    except PluginError as error:
        raise fields.error("kind", str(error)) from error
    except InvalidValue as error:
        raise fields.complaint(str(error)) from error
    fields.done()
    made.made_anew = partial(make_constraint, fields)
    return made
