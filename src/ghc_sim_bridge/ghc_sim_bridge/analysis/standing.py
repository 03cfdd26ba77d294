"""Whether a robot with a floating base stayed up, and how hard its motors worked; no ROS."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.types import Array

HEIGHT_SHARE = 0.1  # [-] of the height that it shall end at
LARGEST_TILT = 10.0  # [deg]


@dataclass(frozen=True, slots=True)
class BaseMotion:
    """Base of a robot at both ends of a run, and how far it went between them."""

    height_start: float  # [m]
    height_end: float  # [m]
    height_lowest: float  # [m]
    tilt_start: float  # [deg] between the base's z axis and the vertical
    tilt_end: float  # [deg]
    tilt_largest: float  # [deg]

    def stands(self, height: float | None = None) -> bool:
        """Whether it ends within a tenth of `height` [m] (of its start) and upright to 10 deg."""
        wanted = self.height_start if height is None else height
        near = abs(self.height_end - wanted) <= HEIGHT_SHARE * wanted
        return near and self.tilt_end < LARGEST_TILT


def base_motion(pose: Array) -> BaseMotion:
    """Motion of a base from its poses (T, 7): position [m], quaternion xyzw; world axes."""
    height, tilt = pose[:, 2], base_tilt(pose)
    return BaseMotion(
        float(height[0]),
        float(height[-1]),
        float(height.min()),
        float(tilt[0]),
        float(tilt[-1]),
        float(tilt.max()),
    )


def base_tilt(pose: Array) -> Array:
    """Angle between the base's z axis and the vertical, (T,) [deg], of poses (T, 7)."""
    x, y = pose[:, 3], pose[:, 4]
    across = 2.0 * np.hypot(x, y) * np.hypot(pose[:, 5], pose[:, 6])  # sine of the angle
    up = 1.0 - 2.0 * (x**2 + y**2)
    return np.asarray(np.degrees(np.arctan2(across, up)))


def torque_use(torque: Array, limit: Array, joint_names: Sequence[str]) -> tuple[float, str]:
    """Largest |torque| over its limit [-] of torques (T, n) and limits (n,) [Nm], and the joint.

    A joint without a limit (infinite) does not count.
    """
    use = np.abs(torque).max(axis=0, initial=0.0) / limit
    worst = int(use.argmax())
    return float(use[worst]), joint_names[worst]
