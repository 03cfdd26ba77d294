"""Braking in acceleration space: what the arm does when there is no other answer."""

from __future__ import annotations

import numpy as np

from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.types import Array, Dynamics

TIME_CONSTANT = 0.05  # [s] velocities decay with it
MAX_ACCELERATION = 25.0  # [rad/s^2] keeps the braking torque small when v is large


def braking_torque(
    dynamics: Dynamics,
    velocity: Array,
    torque_limit: Array,
    time_constant: float = TIME_CONSTANT,
    max_acceleration: float = MAX_ACCELERATION,
    contact_rows: ContactRows | None = None,
) -> Array:
    """Torque (a,) [Nm] that slows every joint down and then holds it against gravity.

    x_b = clip(-v / time_constant), tau = clip(M x_b + h) to the torque limits. Scaled by the mass
    matrix it is stable on light joints, where tau = g - k v with one k for all joints diverges.

    Args:
        dynamics: at the current state.
        velocity: (n,) [rad/s]; the base of a floating one (the first n - a entries) is asked to
            stay, as far as forces at the contacts can carry it.
        torque_limit: (a,) [Nm].
        time_constant: [s]; at least a few control periods.
        max_acceleration: [rad/s^2].
        contact_rows: contacts that are on; their forces are the smallest that fit, friction aside.
    """
    base = velocity.shape[0] - torque_limit.shape[0]
    acceleration = np.clip(-velocity / time_constant, -max_acceleration, max_acceleration)
    acceleration[:base] = 0.0
    generalized = dynamics.mass_matrix @ acceleration + dynamics.bias
    if base and contact_rows is not None:
        push = contact_rows.force_jacobian.T
        generalized -= push @ np.linalg.lstsq(push[:base], generalized[:base], rcond=1e-9)[0]
    torque = generalized[base:]
    return np.clip(torque, -torque_limit, torque_limit)
