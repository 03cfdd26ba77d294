"""Differences and moves of targets: plain vectors, and rotations by rotation vectors."""

from __future__ import annotations

import numpy as np

from ghc_controller.numerics.rotation import (
    quaternion_conjugate,
    quaternion_product,
    rotation_exp,
    rotation_log,
)
from ghc_controller.types import Array


def difference(value: Array, origin: Array, rotation: bool) -> Array:
    """From `origin` to `value`: (m,), of quaternions the rotation vector in world axes (3,)."""
    if not rotation:
        return value - origin
    turn = quaternion_product(value, quaternion_conjugate(origin))
    return np.asarray(rotation_log(turn))


def moved(origin: Array, step: Array, rotation: bool) -> Array:
    """`origin` moved by `step`, the inverse of `difference`."""
    if not rotation:
        return origin + step
    value = np.asarray(quaternion_product(rotation_exp(step), origin))
    return value / float(np.linalg.norm(value))
