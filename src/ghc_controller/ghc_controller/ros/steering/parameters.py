"""Parameters of the steering page."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.schema.domains import Range
from ghc_controller.schema.parameters import EXECUTOR, given, parameter


@dataclass(frozen=True, slots=True)
class SteeringParameters:
    """Parameters of steering_page."""

    robot: str = parameter("", "name of a robot, or path of its robot.yaml", given)
    port: int = parameter(
        0, "of the page on 127.0.0.1; 0 = a free one", Range(minimum=0.0, maximum=65535.0)
    )
    executor: str = EXECUTOR
