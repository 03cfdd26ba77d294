"""Parts of a robot, built from the fields of robot.yaml: model, tasks, contacts, constraints.

Each function raises ConfigurationError with the file, the field, what was given and expected.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from ghc_controller.constraints import Constraint
from ghc_controller.constraints.registry import make_constraint
from ghc_controller.contacts.contact import Contact
from ghc_controller.contacts.registry import make_contact
from ghc_controller.errors import ConfigurationError, GhcError, InvalidValue
from ghc_controller.hierarchy import matrix_from_hierarchy
from ghc_controller.model.limits import JointLimits, Limit, overridden
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.brakes import check_brakes
from ghc_controller.robot.fields import RobotFields
from ghc_controller.robot.link_bodies import link_bodies
from ghc_controller.safety.torque_gate import DEFAULT_TORQUE_RATE
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.registry import make_task
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array


def check_hierarchy(hierarchy: str, tasks: tuple[Task, ...], fields: Fields) -> None:
    """The hierarchy at the start names tasks of the robot."""
    try:
        matrix_from_hierarchy([task.name for task in tasks], hierarchy)
    except GhcError as error:
        raise fields.error("hierarchy", str(error)) from error


def torque_rate_limit(limits: Fields, given: Limit, joint_names: tuple[str, ...]) -> float | Array:
    """One number [Nm/s], or (a,) where the file has a map; joints that it leaves out: default."""
    usual = np.full(len(joint_names), DEFAULT_TORQUE_RATE)
    try:
        rates = overridden(usual, given, joint_names, "torque_rate")
    except GhcError as error:
        raise limits.error("torque_rate", str(error)) from error
    return rates if isinstance(given, Mapping) else float(rates[0])


def build_model(urdf: Path, given: RobotFields, fields: Fields) -> RobotModel:
    """The model of the URDF, with the limits of robot.yaml."""
    model = RobotModel.from_urdf(urdf, given.floating_base)
    model.collision_shapes = partial(link_bodies, urdf)
    limits = fields.section("limits", optional=True)
    values, names = model.limits, model.joint_names
    model.limits = JointLimits(
        values.position_lower,
        values.position_upper,
        _limit(limits, "velocity", given.limits.velocity, values.velocity, names),
        _limit(limits, "torque", given.limits.torque, values.torque, names),
    )
    for joint, lower, upper in zip(
        names, values.position_lower, values.position_upper, strict=True
    ):
        if not lower < upper:
            raise ConfigurationError(
                f"{urdf}: joint '{joint}': lower position limit {lower:g} is not below upper"
                f" {upper:g}"
            )
    try:
        check_brakes(model, given.limits.brake_acceleration)
    except InvalidValue as error:
        raise limits.error("brake_acceleration", str(error)) from error
    return model


def _limit(
    limits: Fields, field: str, given: Limit, values: Array, joint_names: tuple[str, ...]
) -> Array:
    try:
        result = overridden(values, given, joint_names, field)
    except GhcError as error:
        raise limits.error(field, str(error)) from error
    for joint, value in zip(joint_names, result, strict=True):
        if not value > 0.0:
            raise limits.error(
                field, f"the URDF gives {value:g} for joint '{joint}'; a positive limit expected"
            )
    return result


def build_tasks(entries: tuple[Fields, ...], model: RobotModel) -> tuple[Task, ...]:
    """Tasks in the order of the file; names differ."""
    tasks: dict[str, Task] = {}
    for entry in entries:
        try:
            task = make_task(entry, model)
        except ConfigurationError:
            raise
        except GhcError as error:
            raise entry.complaint(str(error)) from error
        if task.name in tasks:
            raise entry.error("name", f"'{task.name}' is already taken by another task")
        tasks[task.name] = task
    return tuple(tasks.values())


def build_contacts(
    entries: tuple[Fields, ...], model: RobotModel, tasks: tuple[Task, ...]
) -> tuple[Contact, ...]:
    """Contacts in the order of the file; names differ, also from those of tasks."""
    contacts: dict[str, Contact] = {}
    taken = {task.name for task in tasks}
    for entry in entries:
        try:
            contact = make_contact(entry, model)
        except InvalidValue as error:
            raise entry.complaint(str(error)) from error
        if contact.name in contacts:
            raise entry.error("name", f"'{contact.name}' is already taken by another contact")
        if contact.force_task is not None and contact.name in taken:
            raise entry.error("name", f"'{contact.name}' is already taken by a task")
        contacts[contact.name] = contact
    return tuple(contacts.values())


def build_constraints(entries: tuple[Fields, ...], model: RobotModel) -> tuple[Constraint, ...]:
    """Constraints in the order of the file; names differ."""
    constraints: dict[str, Constraint] = {}
    for entry in entries:
        constraint = make_constraint(entry, model)
        if constraint.name in constraints:
            raise entry.error(
                "name", f"'{constraint.name}' is already taken by another constraint"
            )
        constraints[constraint.name] = constraint
    return tuple(constraints.values())
