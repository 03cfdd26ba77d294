"""Settings of the reachable references."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import AT_LEAST_ONE, NOT_NEGATIVE, POSITIVE, Range


@dataclass(frozen=True, slots=True)
class ReachableSettings:
    """How targets are checked, estimated, solved for and limited.

    Parameters of the node reachable_targets have the same names.

    Raises:
        InvalidValue: a number is not finite or out of range.
    """

    period: float = declared(
        "between two plans", 0.01, unit="s", domain=Range(minimum=0.005, maximum=0.05)
    )
    lead: float = declared(
        "from the state of a plan to its first point", 0.01, unit="s", domain=NOT_NEGATIVE
    )
    acceleration: float = declared(
        "limit of every joint of the reference", 2.5, unit="rad/s^2, m/s^2", domain=POSITIVE
    )
    jerk: float = declared(
        "limit of joints that are far from their goals",
        12.0,
        unit="rad/s^3, m/s^3",
        domain=POSITIVE,
    )
    velocity_share: float = declared(
        "of the robot's velocity limits", 0.8, unit="-", domain=Range(above=0.0, maximum=1.0)
    )
    position_margin: float = declared(
        "kept from position limits, at most 5 % of a range",
        0.05,
        unit="rad, m",
        domain=NOT_NEGATIVE,
    )
    smoothing: float = declared(
        "window over which accelerations are averaged", 0.12, unit="s", domain=POSITIVE
    )
    bandwidth: float = declared(
        "of the filter that follows the estimated target", 12.0, unit="1/s", domain=POSITIVE
    )
    jitter: float = declared(
        "standard deviation of the stamps of targets", 0.005, unit="s", domain=NOT_NEGATIVE
    )
    noise: float = declared(
        "standard deviation of the positions of targets", 2e-4, unit="m, rad", domain=POSITIVE
    )
    jump: float = declared(
        "a target has jumped that is farther from its prediction than this and what it covers at "
        "`speed`",
        0.05,
        unit="m, rad",
        domain=POSITIVE,
    )
    speed: float = declared(
        "times the time between two targets, added to `jump`",
        1.0,
        unit="m/s, rad/s",
        domain=NOT_NEGATIVE,
    )
    largest_jump: float = declared(
        "a farther target is confirmed by two more", 1.0, unit="m, rad", domain=POSITIVE
    )
    stale_after: float = declared(
        "targets with older stamps are rejected", 0.5, unit="s", domain=POSITIVE
    )
    iterations: int = declared(
        "of the kinematic solver per plan", 4, unit="-", domain=AT_LEAST_ONE
    )
    trust_region: float = declared("per iteration", 0.02, unit="rad, m", domain=POSITIVE)
    restarts: int = declared(
        "other postures from which a target that is not met is tried",
        16,
        unit="-",
        domain=NOT_NEGATIVE,
    )

    def __post_init__(self) -> None:
        check(self)
