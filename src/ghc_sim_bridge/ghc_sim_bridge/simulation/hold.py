"""Holding the robot without a controller: gravity compensation and braking.

The braking acts on accelerations, nudot = -v / tau_brake, and not as a damping torque -k v: one
k for all joints is unstable on a light wrist (k dt / inertia > 2) or lame on the shoulder.
"""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array

BRAKE_TIME = 0.05  # [s] time constant with which the velocity decays


def hold_torque(
    mass_matrix: Array,
    bias: Array,
    velocity: Array,
    torque_limit: Array,
    previous: Array | None = None,
    torque_step: float = np.inf,
) -> Array:
    """Torque (n,) [Nm] that keeps a robot at rest where it is, and brings it to rest if it moves.

    tau = s M nudot + h with nudot = -velocity / BRAKE_TIME and the largest s in [0, 1] that the
    bounds allow: braking all joints less keeps their motions decoupled, which clipping a single
    torque would not. A joint whose bias alone is beyond its bounds is clipped.

    Args:
        mass_matrix: (n, n) M [kg m^2]
        bias: (n,) h, Coriolis, centrifugal and gravity torques [Nm]
        velocity: (n,) [rad/s]
        torque_limit: (n,) [Nm], inf where there is none
        previous: (n,) [Nm] torque applied over the last control period
        torque_step: largest change from `previous` per control period [Nm]; inf = no limit
    """
    lower, upper = -torque_limit, torque_limit
    if previous is not None and np.isfinite(torque_step):
        # Where the last torque is itself outside the limits, the limits win.
        lower = np.minimum(np.maximum(lower, previous - torque_step), upper)
        upper = np.maximum(np.minimum(upper, previous + torque_step), -torque_limit)
    braking = mass_matrix @ (-velocity / BRAKE_TIME)
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.where(braking > 0.0, upper - bias, lower - bias) / braking
    room[(braking == 0.0) | (bias < lower) | (bias > upper)] = np.inf
    scale = float(np.clip(room.min(initial=np.inf), 0.0, 1.0))
    torque: Array = np.minimum(np.maximum(scale * braking + bias, lower), upper)
    return torque
