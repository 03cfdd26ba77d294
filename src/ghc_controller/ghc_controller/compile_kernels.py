"""Compiles every kernel into the cache beside its source: `python -m` with this module.

A controller compiles what it needs before its first step. With the cache filled that takes a
fraction of a second, without it some twenty seconds.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ghc_controller.contacts.registry import make_contact
from ghc_controller.controller import Controller
from ghc_controller.formulations import FORMULATIONS
from ghc_controller.robot.library import ROBOTS, find_robot
from ghc_controller.robot.robot import Robot, load_robot_config
from ghc_controller.robot.urdf import package_of
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.settings import Settings
from ghc_controller.tasks.registry import make_task

_GAINS: dict[str, object] = {"stiffness": 30.0, "damping": 20.0}
_CONTACTS: tuple[dict[str, object], ...] = (
    {"name": "point", "points": [[0, 0, 0]], "normal": [0, 0, 1], "force_task": {"weight": 1.0}},
    {"name": "smooth", "points": [[0, 0, 0.1]], "normal": [0, 1, 0], "friction": 0.0},
)


def every_kind_of_task() -> Robot:
    """A robot of this package with a task of every kind, one of them with force control."""
    robot = load_robot_config(_robot_file())
    first, frame = robot.model.frame_names[0], robot.model.frame_names[-1]
    force = {"axes": ["z"], "contact": frame, "integral": 1.0}
    entries: list[dict[str, object]] = [
        {"name": "position", "kind": "frame_position", "frame": frame, "force": force},
        {"name": "orientation", "kind": "frame_orientation", "frame": frame},
        {"name": "pose", "kind": "frame_pose", "frame": frame},
        {"name": "seen", "kind": "relative_pose", "frame": frame, "relative_to": first},
        {"name": "mass", "kind": "center_of_mass"},
        {"name": "joints", "kind": "posture"},
    ]
    tasks = tuple(make_task(Fields(entry | _GAINS, __name__), robot.model) for entry in entries)
    contacts = tuple(
        make_contact(Fields({"frame": frame} | entry, __name__), robot.model)
        for entry in _CONTACTS
    )
    hierarchy = " > ".join(task.name for task in tasks)
    return replace(robot, tasks=tasks, hierarchy=hierarchy, contacts=contacts)


def _robot_file() -> Path:
    """The first robot whose model needs no further package."""
    files = map(find_robot, ROBOTS.built_in)
    return next(file for file in files if not package_of(read_yaml(file).value("urdf"), file))


def main() -> None:
    """Compile for every formulation."""
    for formulation in FORMULATIONS.built_in:
        settings = Settings(formulation=formulation, torque_bound=1.0)
        Controller(every_kind_of_task(), settings).warm_up()


if __name__ == "__main__":
    main()
