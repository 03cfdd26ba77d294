"""Rotation vectors and unit quaternions (x, y, z, w).

[a] is the skew matrix of a; exp and log run between rotation vectors and rotations. The right
Jacobian J_r maps the rate of a rotation vector p to the angular velocity of exp(p) in its own
(rotated) axes: w = J_r(p) p', with J_r(p) = I - a [p] + b [p]^2, a = (1 - cos t) / t^2,
b = (t - sin t) / t^3, t = |p|.
"""

from __future__ import annotations

import math

import numpy as np

from ghc_controller.types import Array

_SMALL = 1e-4  # [rad] below it series replace the quotients (error below 1e-17)


def quaternion_from_matrix(rotation: Array) -> Array:
    """Unit quaternion with w >= 0 of a rotation matrix (3, 3)."""
    q = np.empty(4)
    trace = rotation[0, 0] + rotation[1, 1] + rotation[2, 2]
    if trace > 0.0:
        s = 2.0 * math.sqrt(1.0 + trace)
        q[0] = (rotation[2, 1] - rotation[1, 2]) / s
        q[1] = (rotation[0, 2] - rotation[2, 0]) / s
        q[2] = (rotation[1, 0] - rotation[0, 1]) / s
        q[3] = 0.25 * s
    else:
        i = 0
        if rotation[1, 1] > rotation[0, 0]:
            i = 1
        if rotation[2, 2] > rotation[i, i]:
            i = 2
        j, k = (i + 1) % 3, (i + 2) % 3
        s = 2.0 * math.sqrt(max(0.0, 1.0 + rotation[i, i] - rotation[j, j] - rotation[k, k]))
        q[i] = 0.25 * s
        q[j] = (rotation[j, i] + rotation[i, j]) / s
        q[k] = (rotation[k, i] + rotation[i, k]) / s
        q[3] = (rotation[k, j] - rotation[j, k]) / s
        if q[3] < 0.0:
            q[:] = -q
    return q


def matrix_from_quaternion(q: Array) -> Array:
    """Rotation matrix (3, 3) of a unit quaternion."""
    x, y, z, w = map(float, q)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def quaternion_product(a: Array, b: Array) -> Array:
    """Quaternion of the rotation b followed by a: R(result) = R(a) R(b)."""
    x, y, z, w = map(float, a)
    r, s, t, u = map(float, b)
    return np.array(
        [
            w * r + x * u + y * t - z * s,
            w * s + y * u + z * r - x * t,
            w * t + z * u + x * s - y * r,
            w * u - x * r - y * s - z * t,
        ]
    )


def quaternion_conjugate(q: Array) -> Array:
    """Inverse rotation of a unit quaternion."""
    return np.array([-q[0], -q[1], -q[2], q[3]])


def rotation_log(q: Array) -> Array:
    """Rotation vector (3,) [rad] of a unit quaternion, of length at most pi."""
    sign = 1.0 if q[3] >= 0.0 else -1.0
    sine = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    cosine = sign * q[3]
    # angle / sine -> 2 at the identity; atan2 is exact for every other angle
    scale = 2.0 / cosine if sine < 1e-12 else 2.0 * math.atan2(sine, cosine) / sine
    return sign * scale * q[:3]


def rotation_exp(p: Array) -> Array:
    """Unit quaternion of a rotation vector (3,) [rad]."""
    angle = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    scale = 0.5 - angle * angle / 48.0 if angle < _SMALL else math.sin(0.5 * angle) / angle
    return np.array([scale * p[0], scale * p[1], scale * p[2], math.cos(0.5 * angle)])


def cross(a: Array, b: Array) -> Array:
    """Cross product of two (3,) vectors."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def angular_motion(p: Array, rate: Array, rate_change: Array) -> tuple[Array, Array]:
    """Angular velocity and acceleration of exp(p(t)) in its own axes.

    w = J_r p', w' = J_r p'' + J_r' p', from p (3,), rate = p', rate_change = p''.
    """
    a, b, a_slope, b_slope = _coefficients(p)
    along = p[0] * rate[0] + p[1] * rate[1] + p[2] * rate[2]  # t t', so that a' = a_slope * along
    p_rate = cross(p, rate)
    p_p_rate = cross(p, p_rate)
    p_change = cross(p, rate_change)
    velocity = rate - a * p_rate + b * p_p_rate
    acceleration = rate_change - a * p_change + b * cross(p, p_change)
    acceleration += along * (b_slope * p_p_rate - a_slope * p_rate) + b * cross(rate, p_rate)
    return velocity, acceleration


def vector_motion(p: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array]:
    """Inverse of angular_motion: p', p'' from angular velocity and acceleration, |p| < 2 pi."""
    a, b, _, _ = _coefficients(p)
    skew = np.array([[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]])
    jacobian = np.eye(3) - a * skew + b * (skew @ skew)
    rate = np.linalg.solve(jacobian, velocity)
    _, change = angular_motion(p, rate, np.zeros(3))
    return rate, np.linalg.solve(jacobian, acceleration - change)


def _coefficients(p: Array) -> tuple[float, float, float, float]:
    """a, b and their derivatives by t divided by t."""
    t = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    if t < 0.02:  # quotients of cancelling terms: series to t^4 (error below 1e-13)
        s = t * t
        a = 0.5 - s / 24.0 + s * s / 720.0
        b = 1.0 / 6.0 - s / 120.0 + s * s / 5040.0
        return a, b, -1.0 / 12.0 + s / 180.0, -1.0 / 60.0 + s / 1260.0
    sine, cosine = math.sin(t), math.cos(t)
    a = (1.0 - cosine) / t**2
    b = (t - sine) / t**3
    return a, b, (sine - 2.0 * a * t) / t**3, (1.0 - cosine - 3.0 * b * t**2) / t**4
