"""Kinematics of one frame, as views of what the compiled core holds."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class FrameTerms:
    """Kinematics of one frame; views that stay current with RobotModel.update.

    Velocity, drift and Jacobian belong to the frame's origin, in world axes, linear part first
    (Pinocchio's LOCAL_WORLD_ALIGNED): velocity = J v, acceleration = J dv + drift.
    """

    position: Array  # (3,) origin in the world [m]
    rotation: Array  # (3, 3) frame to world
    jacobian: Array  # (6, n)
    velocity: Array  # (6,) [m/s], [rad/s]
    drift: Array  # (6,) dJ/dt v: classical acceleration at dv = 0 [m/s^2], [rad/s^2]

    @classmethod
    def of(cls, arrays: tuple[Array, Array, Array]) -> FrameTerms:
        """Views of rotation above position (4, 3), Jacobian, velocity above drift (2, 6)."""
        pose, jacobian, motion = arrays
        return cls(pose[3], pose[:3], jacobian, motion[0], motion[1])
