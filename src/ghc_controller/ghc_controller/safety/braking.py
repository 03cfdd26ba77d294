"""Braking in acceleration space: what a robot does when there is no other answer.

It acts on accelerations, nudot = -v / BRAKE_TIME, and not as a damping torque -k v: one k for all
joints is unstable on a light wrist (k dt / inertia > 2) or lame on the shoulder. The controller
brakes with `braking_torque`, which knows contacts; the bridge holds an arm that gets no commands
with `hold_torque`, which knows what was applied last.
"""

from __future__ import annotations

import numpy as np

from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.types import Array, Dynamics

BRAKE_TIME = 0.05  # [s] time constant with which velocities decay
MAX_ACCELERATION = 25.0  # [rad/s^2] keeps the braking torque small when v is large


def braking_torque(
    dynamics: Dynamics,
    velocity: Array,
    torque_limit: Array,
    time_constant: float = BRAKE_TIME,
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


def hold_torque(
    mass_matrix: Array,
    bias: Array,
    velocity: Array,
    torque_limit: Array,
    previous: Array | None = None,
    torque_step: Array | float = np.inf,
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
        torque_step: largest change from `previous` per control period [Nm], one number or (n,);
            inf = no limit
    """
    lower, upper = -torque_limit, torque_limit
    if previous is not None:
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
