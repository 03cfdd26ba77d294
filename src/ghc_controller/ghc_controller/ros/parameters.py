"""Parameters of the controller node."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.previews.preview import KINDS
from ghc_controller.ros.process.scheduling import Scheduling
from ghc_controller.safety.modes import Arming
from ghc_controller.schema.declared import inline
from ghc_controller.schema.parameters import (
    EXECUTOR,
    given,
    one_of,
    parameter,
    plan_step,
    rate,
    several_of,
)
from ghc_controller.settings import Settings
from ghc_controller.types import PREVIEW_STEP


@dataclass(frozen=True, slots=True)
class ControllerParameters:
    """Parameters of controller: those of `Settings`, and those of the node itself."""

    robot: str = parameter("", "name of a robot, or path of its robot.yaml", given)
    settings: Settings = inline(Settings)
    lockstep: bool = parameter(
        False, "reject references and transitions whose start has passed, for repeatable runs"
    )
    arming: str = parameter(
        "",
        "what makes the controller move the robot: request (the first one accepted), explicit "
        "(the service controller/arm alone) or automatic (the first state; faults are not "
        "latched); empty = automatic in lockstep, else request",
        one_of("", *(kind.value for kind in Arming)),
    )
    state_rate: float = parameter(
        100.0,
        "[Hz] of the robot's time: controller_state; priority_matrix while it changes",
        rate,
    )
    wait_for_contacts: tuple[str, ...] = parameter(
        (), "contacts whose wrench of the same stamp a step waits for"
    )
    wait_for_bounds: tuple[str, ...] = parameter(
        (),
        f"kinds of previews that a step waits for: {', '.join(KINDS)}",
        several_of(*KINDS),
    )
    bounds_step: float = parameter(PREVIEW_STEP, "[s] between two plans of a generator", plan_step)
    mirror_commands: bool = parameter(
        False, "publish /effort_controller/commands as well, order of the robot model"
    )
    executor: str = EXECUTOR
    scheduling: Scheduling = inline(Scheduling)

    @property
    def armed_by(self) -> Arming:
        """How the controller becomes active."""
        default = Arming.AUTOMATIC if self.lockstep else Arming.REQUEST
        return Arming(self.arming) if self.arming else default
