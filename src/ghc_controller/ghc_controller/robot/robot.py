"""A robot as data: robot.yaml read, checked and turned into a model and tasks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ghc_controller.constraints import Constraint
from ghc_controller.constraints.registry import make_constraint
from ghc_controller.contacts.contact import Contact
from ghc_controller.contacts.registry import make_contact
from ghc_controller.errors import ConfigurationError, GhcError, InvalidValue
from ghc_controller.model.limits import JointLimits, Limit, overridden
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.contact_places import ContactPlace, contact_places
from ghc_controller.robot.fields import RobotFields
from ghc_controller.robot.task_entries import TaskEntry
from ghc_controller.robot.urdf import find_urdf
from ghc_controller.safety.torque_gate import DEFAULT_TORQUE_RATE
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.schema.record import read
from ghc_controller.tasks.registry import make_task
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array


@dataclass(frozen=True)
class Robot:
    """Content of robot.yaml, ready to use.

    ```yaml
    name: my_arm
    urdf: my_arm.urdf            # relative to this file, or of a package: see urdf.py
    floating_base: false         # optional, default false
    limits:                      # optional; a number, or a map joint -> number, overrides the URDF
      velocity: 1.2              # [rad/s]
      torque: {joint_1: 100.0}   # [Nm]
      torque_rate: 1000.0        # [Nm/s]; joints that a map leaves out have the default, 1000
      brake_acceleration: 5.0    # [rad/s^2], one number: what braking before a limit may use
    tasks:                       # names unique; fields by kind: see the files of tasks/
      - {name: hand, kind: frame_position, frame: tool, stiffness: 30.0, damping: 20.0}
    hierarchy: "hand"            # in force at the start
    contacts:                    # optional
      - name: palm               # as in contacts/<name> and in schedules
        kind: rigid              # default; or point, surface, sliding, or of a plug-in
        frame: tool
        points: [[0, 0, 0.1]]    # [m] in the frame; three or more hold the frame as a whole
        normal: [0, 0, 1]        # world axes, as the surroundings push
        friction: 0.5            # [-] default 0.5; 0 = only along the normal
        force_lower: 0.0         # [N] default 0; normal force, where no generator bounds it
        force_upper: 1000.0      # [N] default 1000
        active: false            # default false: on at the start
        on_stale: hold           # default hold; release: once a generator is silent, as above
        force_task: {weight: 1}  # optional: the normal force follows a TaskReference
        sensing: {threshold: 5}  # optional: the measured wrench confirms touch and break
    constraints:                 # optional; fields by kind: see the files of constraints/
      - {name: wall, kind: cartesian_wall, frame: tool, point: [0.5, 0, 0], normal: [-1, 0, 0]}
    settings:                    # optional: of the controller, see ghc.Settings
      velocity_damping: 10.0     # [1/s]
    ```
    """

    path: Path
    name: str
    urdf: Path
    floating_base: bool
    torque_rate: float | Array  # [Nm/s], one number or (a,)
    brake_acceleration: float  # [rad/s^2]
    model: RobotModel  # with the limits of the file
    tasks: tuple[Task, ...]  # k tasks, in the order of the file
    hierarchy: str
    contacts: tuple[Contact, ...] = ()
    constraints: tuple[Constraint, ...] = ()  # beside those of every robot
    settings: Fields | None = None  # of the controller on this robot: see Settings.for_robot
    contact_places: Mapping[str, ContactPlace] = field(default_factory=dict)  # by contact

    @classmethod
    def from_urdf(
        cls,
        urdf: str | Path,
        tasks: Sequence[TaskEntry],
        hierarchy: str,
        *,
        name: str = "",
        floating_base: bool = False,
        limits: Mapping[str, Any] | None = None,
        contacts: Sequence[Mapping[str, Any]] = (),
        constraints: Sequence[Mapping[str, Any]] = (),
        settings: Mapping[str, Any] | None = None,
    ) -> Robot:
        """A robot written in Python: the fields of robot.yaml, read by the same reader.

        Args:
            urdf: path of the URDF. name: that of the file without.
            limits, contacts, constraints, settings: as in robot.yaml.

        Raises:
            ConfigurationError: one line with the field, what was given and expected.
        """
        path = Path(urdf).expanduser().resolve()
        values: dict[str, Any] = {
            "name": name or path.stem,
            "urdf": str(path),
            "floating_base": floating_base,
            "tasks": [task.as_mapping() for task in tasks],
            "hierarchy": hierarchy,
        }
        if limits:
            values["limits"] = dict(limits)
        if contacts:
            values["contacts"] = [dict(contact) for contact in contacts]
        if constraints:
            values["constraints"] = [dict(constraint) for constraint in constraints]
        if settings:
            values["settings"] = dict(settings)
        return _from_fields(Fields(values, "Robot.from_urdf"), path)

    @property
    def task_names(self) -> tuple[str, ...]:
        """Names of the tasks, in the order of the file."""
        return tuple(task.name for task in self.tasks)

    @property
    def felt_contacts(self) -> tuple[str, ...]:
        """Names of the contacts whose measured wrench is used: by sensing, or by force control."""
        sensed = [contact.name for contact in self.contacts if contact.sensing is not None]
        pressed = [task.force.contact for task in self.tasks if task.force is not None]
        return tuple(dict.fromkeys(sensed + pressed))


def load_robot_config(path: str | Path) -> Robot:
    """Read robot.yaml and the URDF that it names, and build model and tasks.

    Raises:
        ConfigurationError: one line with the file, the field, what was given and expected.
    """
    path = Path(path)
    return _from_fields(read_yaml(path), path)


def _from_fields(fields: Fields, path: Path) -> Robot:
    """`path`: robot.yaml, or the URDF of a robot without one."""
    given = read(fields, RobotFields)
    urdf = find_urdf(given.urdf, path)
    model = _build_model(urdf, given, fields)
    tasks = _build_tasks(given.tasks, model)
    return Robot(
        path,
        given.name,
        urdf,
        given.floating_base,
        _torque_rate(
            fields.section("limits", optional=True), given.limits.torque_rate, model.joint_names
        ),
        given.limits.brake_acceleration,
        model,
        tasks,
        given.hierarchy,
        _build_contacts(given.contacts, model, tasks),
        _build_constraints(given.constraints, model),
        given.settings,
        contact_places(given.contacts),
    )


def _torque_rate(limits: Fields, given: Limit, joint_names: tuple[str, ...]) -> float | Array:
    """One number [Nm/s], or (a,) where the file has a map; joints that it leaves out: default."""
    usual = np.full(len(joint_names), DEFAULT_TORQUE_RATE)
    try:
        rates = overridden(usual, given, joint_names, "torque_rate")
    except GhcError as error:
        raise limits.error("torque_rate", str(error)) from error
    return rates if isinstance(given, Mapping) else float(rates[0])


def _build_model(urdf: Path, given: RobotFields, fields: Fields) -> RobotModel:
    model = RobotModel.from_urdf(urdf, given.floating_base)
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


def _build_tasks(entries: tuple[Fields, ...], model: RobotModel) -> tuple[Task, ...]:
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


def _build_contacts(
    entries: tuple[Fields, ...], model: RobotModel, tasks: tuple[Task, ...]
) -> tuple[Contact, ...]:
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


def _build_constraints(entries: tuple[Fields, ...], model: RobotModel) -> tuple[Constraint, ...]:
    constraints: dict[str, Constraint] = {}
    for entry in entries:
        constraint = make_constraint(entry, model)
        if constraint.name in constraints:
            raise entry.error(
                "name", f"'{constraint.name}' is already taken by another constraint"
            )
        constraints[constraint.name] = constraint
    return tuple(constraints.values())
