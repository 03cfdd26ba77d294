"""`ros2 run ghc_controller new_robot model.urdf`: first files of an arm or a legged robot."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from ghc_controller.errors import ConfigurationError, GhcError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.first_files import legged_texts
from ghc_controller.robot.first_files.choices import Choices, choose
from ghc_controller.robot.first_files.legged import Stance, choose_stance
from ghc_controller.robot.first_files.srdf import group_state
from ghc_controller.robot.first_files.texts import SWAP, robot_text, scenario_text, scene_text
from ghc_controller.robot.urdf import find_urdf

_NEAR = 2  # [-] folders up to which a path relative to robot.yaml is written


def main(arguments: Sequence[str] | None = None) -> int:
    """0 = the files were written, 1 = they were not (with a one-line message)."""
    parser = argparse.ArgumentParser(prog="new_robot", description=__doc__.splitlines()[0])
    parser.add_argument("urdf", type=Path, help="URDF, xacro or MJCF of an arm or a legged robot")
    parser.add_argument("--folder", type=Path, help="for the files; left out = ./<name>")
    parser.add_argument("--name", help="of the robot; left out = that of the URDF's file")
    parser.add_argument("--srdf", type=Path, help="its group states are start postures")
    parser.add_argument("--pose", default="", help="group state; left out = the most complete")
    options = parser.parse_args(arguments)
    name = options.name or options.urdf.name.partition(".")[0]
    folder = options.folder or Path(name)
    try:
        chosen = write_first_files(options.urdf, folder, name, options.srdf, options.pose)
    except GhcError as error:
        print(f"new_robot: {error}", file=sys.stderr)
        return 1
    print(
        f"{folder}: robot.yaml, scene.yaml, {SWAP}.yaml\n"
        f"{_summary(chosen)}\n"
        f"next:  ros2 run ghc_sim_bridge experiment --scenario {folder / SWAP}.yaml"
    )
    for limit, joints in (
        ("torque", chosen.without_torque),
        ("velocity", chosen.without_velocity),
    ):
        if joints:
            print(
                f"check: the URDF has no {limit} limit of {', '.join(joints)}; a small one is set"
            )
    return 0


def _summary(chosen: Choices | Stance) -> str:
    if isinstance(chosen, Choices):
        return f"tasks: end_effector = {chosen.end_effector}, elbow = {chosen.elbow}, posture"
    feet = ", ".join(foot.frame for foot in chosen.feet)
    hand = f"hand = {chosen.hand}, " if chosen.hand else ""
    return (
        f"a floating base '{chosen.base}' that stands on {feet}: check the contact points\n"
        f"tasks: center_of_mass, base_orientation, {hand}posture"
    )


def write_first_files(
    urdf: Path, folder: Path, name: str, srdf: Path | None = None, pose: str = ""
) -> Choices | Stance:
    """Write robot.yaml, scene.yaml and swap.yaml; returns the choices.

    A robot with legs gets a floating base and stands on its feet: see `find_feet`.

    Args:
        srdf, pose: file and group state of the start posture; without, one is chosen.

    Raises:
        ConfigurationError: no readable URDF, an unsupported robot, or a folder that already
            contains such files.
    """
    if not urdf.is_file():
        raise ConfigurationError(f"{urdf}: robot model does not exist")
    files = {file: folder / file for file in ("robot.yaml", "scene.yaml", f"{SWAP}.yaml")}
    taken = [str(path) for path in files.values() if path.exists()]
    if taken:
        raise ConfigurationError(f"{taken[0]} exists already; give another --folder")
    read = find_urdf(str(urdf.resolve()), folder / "robot.yaml")
    place = os.path.relpath(urdf.resolve(), folder.resolve())
    if place.count("..") > _NEAR:
        place = str(urdf.resolve())
    chosen, texts = _chosen(read, place, name, srdf, pose)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path, text in zip(files.values(), texts, strict=True):
            path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"{folder}: cannot be written: {error.strerror}") from error
    return chosen


def _chosen(
    urdf: Path, place: str, name: str, srdf: Path | None, pose: str
) -> tuple[Choices | Stance, tuple[str, str, str]]:
    """What is chosen, and robot.yaml, scene and scenario that say it."""
    model = RobotModel.from_urdf(urdf)
    start = None if srdf is None else group_state(srdf, model, pose)
    floating = RobotModel.from_urdf(urdf, floating_base=True)
    stance = choose_stance(urdf, floating, start)
    if stance is not None:
        return stance, (
            legged_texts.robot_text(name, place, floating, stance),
            legged_texts.scene_text(name, floating, stance),
            legged_texts.scenario_text(name, stance),
        )
    chosen = choose(model, start)
    return chosen, (
        robot_text(name, place, model, chosen),
        scene_text(name, model, chosen),
        scenario_text(name, chosen),
    )
