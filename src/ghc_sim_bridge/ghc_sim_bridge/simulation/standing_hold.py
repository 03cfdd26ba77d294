"""Holding a robot with a floating base without a controller: it keeps the posture it has.

Inverse dynamics of a robot whose touching points stick: accelerations that bring the joints back
to the held posture, a base that follows, and the contact forces that carry the motion. It knows no
limits of contacts (they may pull or slip) and no balance: a robot that stands well over its soles
remains standing, one that does not falls with stiff joints. The hold is stable, because the gains
act on accelerations and not on torques: light and heavy joints slow down alike.
"""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array, Dynamics

STIFFNESS, DAMPING = 100.0, 20.0  # [1/s^2], [1/s] of the held posture
CONTACT_DAMPING = 20.0  # [1/s] of a touching point that still moves
_CONTACT_WEIGHT = 30.0  # of points that stick, against 1 of the posture
_FLIGHT_WEIGHT = 1e-6  # of the base: it does what contacts and posture leave to it
_DAMPED = 1e-6  # regularization of the contact forces, relative
_BASE_NV = 6


def standing_torque(
    dynamics: Dynamics,
    contact_jacobian: Array,
    velocity: Array,
    posture_error: Array,
) -> Array:
    """Torque (na,) [Nm] of the motors that keeps a posture, base following, contacts sticking.

    Args:
        dynamics: M (n, n) and h (n,), n = 6 + na.
        contact_jacobian: (m, n) velocity of the touching points, m = 0 in free flight.
        velocity: (n,) [m/s], [rad/s].
        posture_error: (na,) [rad] held posture less the present one.
    """
    mass, bias = dynamics.mass_matrix, dynamics.bias
    base, joints = slice(0, _BASE_NV), slice(_BASE_NV, None)
    m, n = contact_jacobian.shape
    wanted = STIFFNESS * posture_error - DAMPING * velocity[joints]
    # Where no contact says how the base moves, it moves as in free flight.
    flight = np.linalg.solve(mass[base, base], -bias[base] - mass[base, joints] @ wanted)
    weights = np.concatenate(
        [np.full(m, _CONTACT_WEIGHT), np.full(_BASE_NV, _FLIGHT_WEIGHT), np.ones(n - _BASE_NV)]
    )
    rows = np.vstack([contact_jacobian, np.eye(n)])
    still = -CONTACT_DAMPING * (contact_jacobian @ velocity)
    target = np.concatenate([still, flight, wanted])
    acceleration = np.linalg.lstsq(weights[:, None] * rows, weights * target, rcond=None)[0]
    effort = mass @ acceleration + bias  # (n,) of motors and contacts together
    if m:
        effort -= contact_jacobian.T @ _carrying_forces(contact_jacobian[:, base], effort[base])
    return np.asarray(effort[joints])


def _carrying_forces(jacobian: Array, effort: Array) -> Array:
    """Smallest contact forces (m,) [N] that exert `effort` (6,) on the base through J (m, 6)."""
    gram = jacobian.T @ jacobian
    gram[np.diag_indices(_BASE_NV)] += _DAMPED * np.trace(gram) / _BASE_NV
    return np.asarray(jacobian @ np.linalg.solve(gram, effort))


class StandingHold:
    """Stores the posture in which the hold began."""

    def __init__(self) -> None:
        """Nothing held yet."""
        self._posture: Array | None = None

    def release(self) -> None:
        """A command moves the robot: the next hold takes the posture it finds."""
        self._posture = None

    def torque(self, dynamics: Dynamics, contact_jacobian: Array, q: Array, v: Array) -> Array:
        """Torque (na,) [Nm] at the state q (na,) [rad] of the joints and v (n,)."""
        if self._posture is None:
            self._posture = q.copy()
        return standing_torque(dynamics, contact_jacobian, v, self._posture - q)
