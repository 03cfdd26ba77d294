"""Whether a robot with a floating base stayed up, and how hard its motors worked; no ROS."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class Standing:
    """Where a base has to be for the robot to stand."""

    lowest: float  # [-] share of the wanted height
    highest: float  # [-]
    largest_tilt: float  # [deg] between the base's z axis and the vertical

    def holds(self, height: float, tilt: float, wanted: float) -> bool:
        """Whether a base at `height` [m], tilted by `tilt` [deg], stands at `wanted` [m]."""
        high_enough = self.lowest * wanted <= height <= self.highest * wanted
        return high_enough and tilt <= self.largest_tilt


AS_PLANNED = Standing(0.9, 1.1, 10.0)  # an undisturbed run ends where its scenario says
NOT_FALLEN = Standing(0.8, math.inf, math.degrees(0.35))  # a disturbed one is still up


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
        """Whether it ends `AS_PLANNED` at `height` [m]; None = that of its start."""
        wanted = self.height_start if height is None else height
        return AS_PLANNED.holds(self.height_end, self.tilt_end, wanted)


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
