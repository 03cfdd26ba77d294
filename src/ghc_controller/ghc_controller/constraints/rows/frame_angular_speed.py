"""A maximum angular speed of a frame."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.constraints.registry import register_constraint
from ghc_controller.constraints.rows.frame_speed import FrameSpeed, FrameSpeedFields
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import POSITIVE


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameAngularSpeedFields(FrameSpeedFields):
    """Fields of the kind `frame_angular_speed`."""

    frame: str = declared("frame of the URDF, such as that of a floating base", names="frame")
    limit: float = declared("of its rotation", unit="rad/s", domain=POSITIVE)


@register_constraint("frame_angular_speed")
class FrameAngularSpeed(FrameSpeed):
    """|w| <= limit for the angular velocity w of a frame, a row along its axis of rotation."""

    entry = FrameAngularSpeedFields
    coordinates = slice(3, 6)
