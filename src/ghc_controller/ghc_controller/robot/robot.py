"""A robot as data: robot.yaml read, checked and turned into a model and tasks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from ghc_controller.constraints import Constraint
from ghc_controller.contacts.contact import Contact
from ghc_controller.model.configuration import Configuration
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.contact_places import ContactPlace, contact_places
from ghc_controller.robot.fields import RobotFields
from ghc_controller.robot.parts import (
    build_constraints,
    build_contacts,
    build_model,
    build_tasks,
    check_hierarchy,
    torque_rate_limit,
)
from ghc_controller.robot.task_entries import TaskEntry
from ghc_controller.robot.urdf import find_urdf
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.schema.record import read
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
      brake_acceleration: 5.0    # [rad/s^2], one number: deceleration before a limit
    tasks:                       # names unique; fields by kind: see the files of tasks/
      - {name: hand, kind: frame_position, frame: tool, stiffness: 30.0, damping: 20.0}
    hierarchy: "hand"            # at the start
    contacts:                    # optional
      - name: palm               # as in contacts/<name> and in schedules
        kind: rigid              # default; or point, surface, sliding, or of a plug-in
        frame: tool
        points: [[0, 0, 0.1]]    # [m] in the frame; three or more fix the whole frame
        normal: [0, 0, 1]        # world axes, as the environment pushes
        friction: 0.5            # [-] default 0.5; 0 = only along the normal
        force_lower: 0.0         # [N] default 0; normal force, where no generator bounds it
        force_upper: 1000.0      # [N] default 1000
        active: false            # default false: on at the start
        on_stale: hold           # default hold; release: bounds as above once a preview has ended
        force_task: {weight: 1}  # optional: the normal force follows a TaskReference
        sensing: {threshold: 5}  # optional: the measured wrench confirms touch-down and lift-off
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
    constraints: tuple[Constraint, ...] = ()  # in addition to those of every robot
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

    def copy(self) -> Robot:
        """The same robot with a model, tasks and constraints of its own.

        Contacts are values; a constraint made by hand, and not from an entry of a file, is the
        same object.
        """
        model = self.model.copy()
        constraints = tuple(
            one if one.made_anew is None else one.made_anew(model) for one in self.constraints
        )
        tasks = tuple(task.copy() for task in self.tasks)
        return replace(self, model=model, tasks=tasks, constraints=constraints)

    def at(self, q: ArrayLike, v: ArrayLike | None = None) -> Configuration:
        """The robot at q (nq,) and v (n,), at rest without v: a value that never changes.

        Copies the model once; `update` of what is returned is the fast way to other states.

        Raises:
            WrongSize, InvalidValue: wrong shapes, or a number that is not finite.
        """
        return Configuration.of(self.model, q, v)

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
    if not urdf.is_file():
        raise fields.error("urdf", f"{urdf}: robot model does not exist")
    model = build_model(urdf, given, fields)
    tasks = build_tasks(given.tasks, model)
    check_hierarchy(given.hierarchy, tasks, fields)
    return Robot(
        path,
        given.name,
        urdf,
        given.floating_base,
        torque_rate_limit(
            fields.section("limits", optional=True), given.limits.torque_rate, model.joint_names
        ),
        given.limits.brake_acceleration,
        model,
        tasks,
        given.hierarchy,
        build_contacts(given.contacts, model, tasks),
        build_constraints(given.constraints, model),
        given.settings,
        contact_places(given.contacts),
    )
