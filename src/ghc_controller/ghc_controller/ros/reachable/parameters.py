"""Parameters of the node of reachable targets."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.reachable import ReachableSettings
from ghc_controller.schema.parameters import (
    EXECUTOR,
    given,
    not_negative,
    one_of,
    parameter,
    positive,
)

_DEFAULTS = ReachableSettings()


@dataclass(frozen=True, slots=True)
class ReachableTargetsParameters:
    """Parameters of reachable_targets."""

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
    period: float = parameter(_DEFAULTS.period, "[s] between two plans, 0.005 to 0.05", positive)
    lead: float = parameter(
        _DEFAULTS.lead, "[s] from the state of a plan to its first point", not_negative
    )
    acceleration: float = parameter(
        _DEFAULTS.acceleration,
        "[rad/s^2], [m/s^2] limit of every joint of the reference",
        positive,
    )
    velocity_share: float = parameter(
        _DEFAULTS.velocity_share, "[-] of the robot's velocity limits, at most 1", positive
    )
    position_margin: float = parameter(
        _DEFAULTS.position_margin,
        "[rad], [m] kept from position limits, at most 5 % of a range",
        not_negative,
    )
    smoothing: float = parameter(
        _DEFAULTS.smoothing, "[s] window over which accelerations are averaged", positive
    )
    bandwidth: float = parameter(
        _DEFAULTS.bandwidth, "[1/s] of the filter that follows the estimated target", positive
    )
    jitter: float = parameter(
        _DEFAULTS.jitter, "[s] standard deviation of the stamps of targets", not_negative
    )
    noise: float = parameter(
        _DEFAULTS.noise, "[m], [rad] standard deviation of the positions of targets", positive
    )
    jump: float = parameter(
        _DEFAULTS.jump,
        "[m], [rad] beyond its prediction, and 1 m/s, a target has jumped",
        positive,
    )
    largest_jump: float = parameter(
        _DEFAULTS.largest_jump, "[m], [rad] a farther target is confirmed by two more", positive
    )
    stale_after: float = parameter(
        _DEFAULTS.stale_after, "[s] targets with older stamps are rejected", positive
    )
    executor: str = EXECUTOR

    def settings(self) -> ReachableSettings:
        """Settings of the library; GhcError for a value out of range."""
        return ReachableSettings(
            period=self.period,
            lead=self.lead,
            acceleration=self.acceleration,
            velocity_share=self.velocity_share,
            position_margin=self.position_margin,
            smoothing=self.smoothing,
            bandwidth=self.bandwidth,
            jitter=self.jitter,
            noise=self.noise,
            jump=self.jump,
            largest_jump=self.largest_jump,
            stale_after=self.stale_after,
        )
