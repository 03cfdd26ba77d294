"""Parameters of the node of priorities that follow a distance."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.schema.parameters import EXECUTOR, given, not_negative, parameter, positive


@dataclass(frozen=True, slots=True)
class PriorityShareParameters:
    """Parameters of priority_share: two orders, the error between them, and how fast."""

    first: str = parameter("", "hierarchy while the share is 0", given)
    second: str = parameter("", "hierarchy while the share is 1", given)
    task: str = parameter(
        "",
        "whose error (ghc/controller_state) the share follows: its row, or its norm with several "
        "rows",
        given,
    )
    begins: float = parameter(0.0, "[m], [rad] error at which the share is 0")
    ends: float = parameter(0.0, "[m], [rad] error at which the share is 1; not that of begins")
    lag: float = parameter(0.03, "[s] time constant with which the share follows", positive)
    full_way: float = parameter(0.2, "[s] from 0 to 1 at least", positive)
    torque_rate: float = parameter(
        0.0, "[Nm/s] that the ramps may add to any joint; 0 = no budget", not_negative
    )
    executor: str = EXECUTOR
