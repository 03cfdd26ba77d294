"""The robot of a bench: its scene, and two orders of its tasks that requests alternate between."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Subject:
    """Names as in scenes and robots of the packages."""

    scene: str
    robot: str
    orders: tuple[str, str]


ARM = Subject(
    "kuka_lwr",
    "kuka_lwr",
    ("end_effector > elbow > posture", "elbow > end_effector > posture"),
)
HUMANOID = Subject(  # on both feet, its base floating
    "icub_standing",
    "icub",
    (
        "center_of_mass > root_orientation = chest_orientation > left_hand = right_hand > posture",
        "center_of_mass > root_orientation > chest_orientation > left_hand = right_hand > posture",
    ),
)
