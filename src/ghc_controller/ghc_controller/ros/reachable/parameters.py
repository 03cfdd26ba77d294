"""Parameters of the node of reachable targets."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.reachable import ReachableSettings
from ghc_controller.schema.declared import inline
from ghc_controller.schema.parameters import EXECUTOR, given, one_of, parameter


@dataclass(frozen=True, slots=True)
class ReachableTargetsParameters:
    """Parameters of reachable_targets: those of its settings, and those of the node itself."""

    robot: str = parameter("", "name of a robot, or path of its robot.yaml", given)
    tasks: tuple[str, ...] = parameter(
        (), "tasks with a target stream, highest priority first; empty = the robot's first task"
    )
    posture: str = parameter(
        "", "posture task that is given the posture of the reference; empty = none"
    )
    world_frame: str = parameter(
        "world", "frame_id of targets; the empty one means the same", given
    )
    stamps: str = parameter(
        "header",
        "when a target was there: header (zero = arrival) or arrival",
        one_of("header", "arrival"),
    )
    settings: ReachableSettings = inline(ReachableSettings)
    executor: str = EXECUTOR
