"""Parameters of the node for displays."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.schema.domains import Range
from ghc_controller.schema.parameters import EXECUTOR, given, not_negative, parameter


@dataclass(frozen=True, slots=True)
class DisplayParameters:
    """Parameters of display_publisher."""

    robot: str = parameter("", "name of a robot, or path of its robot.yaml; empty = of the scene")
    scene: str = parameter(
        "", "name or path of a scene, whose surfaces and contacts are shown too; empty = none"
    )
    description: str = parameter(
        "", "URDF that is drawn instead of the robot's, such as one with its gripper"
    )
    rate: float = parameter(
        30.0, "[Hz] wall, at most: transforms and markers", Range(above=0.0, maximum=100.0)
    )
    world_frame: str = parameter("world", "frame_id of the world", given)
    frame_prefix: str = parameter(
        "",
        "in front of the links' names on /tf (the TF prefix of RViz), such as left/; "
        "empty = the namespace of the node",
    )
    force_scale: float = parameter(0.002, "[m/N] length of the arrows of forces", not_negative)
    executor: str = EXECUTOR
