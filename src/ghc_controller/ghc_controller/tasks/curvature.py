"""Second-order terms of points and orientations from Jacobian columns alone.

z_a is the angular column of velocity coordinate a and J_b the linear column of b, both in world
axes. A joint turns the columns of all joints that it carries, so that for a nearer to the base
    d2 p / dq_a dq_b = z_a x J_b,        d2 phi / dq_a dq_b = 1/2 z_a x z_b,
p a point fixed in a link (or the center of mass) and phi = log(R(q + dq) R(q)^T). The coordinates
of one floating base move together along exp(v, w): there the mean of both orders stands.
"""

from __future__ import annotations

import math

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array

_SMALL = 1e-2  # [rad] below which the series is exact to 1e-13


def point_curvature(model: RobotModel, angular: Array, linear: Array, weights: Array) -> Array:
    """sum_r weights_r grad^2 p_r, (n, n) symmetric.

    Args:
        angular, linear: (3, n) columns z and J. weights: (3,) along world axes.
    """
    # weights . (z_a x J_b) = (weights x z_a) . J_b, a nearer to the base than b
    terms = np.where(model.carries, np.cross(weights, angular.T) @ linear, 0.0)
    both = np.where(model.joint_of[:, None] == model.joint_of, 0.5 * terms, terms)
    return np.asarray(both + both.T)


def rotation_curvature(model: RobotModel, angular: Array, weights: Array) -> Array:
    """sum_r weights_r grad^2 phi_r, (n, n) symmetric; weights (3,)."""
    return 0.5 * point_curvature(model, angular, angular, weights)


def rotation_error_term(angular: Array, error: Array) -> Array:
    """T (n, n) with grad^2 (1/2 |e|^2) = J^T J + T - sum_r e_r grad^2 phi_r, e = log(R* R^T).

    The gradient is -J^T e, and e' = -J_r(e)^-1 J q' with the right Jacobian J_r of rotation.py,
    whose inverse has the symmetric part I + c [e]^2, c = (1 - |e|/2 cot(|e|/2)) / |e|^2.

    Args:
        angular: J (3, n). error: e (3,), 0 <= |e| <= pi.
    """
    angle = float(np.linalg.norm(error))
    if angle < _SMALL:
        c = 1.0 / 12.0 + angle * angle / 720.0
    else:
        c = (1.0 - 0.5 * angle / math.tan(0.5 * angle)) / angle**2
    along = error @ angular
    return np.asarray(c * (np.outer(along, along) - angle**2 * (angular.T @ angular)))
