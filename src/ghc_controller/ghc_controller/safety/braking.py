"""Braking in acceleration space: the fallback if there is no other solution.

The only braking law: used by the controller without a solution, by its gate, and by the bridge
that holds an arm without commands. It acts on accelerations, dv = -v / BRAKE_TIME, and not as a
damping torque -k v: one k for all joints is unstable on a light wrist (k dt / inertia > 2) or too
weak on the shoulder.
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
    contact_rows: ContactRows | None = None,
    previous: Array | None = None,
    torque_step: Array | float = np.inf,
    max_acceleration: float = MAX_ACCELERATION,
    lower: Array | None = None,
) -> Array:
    """Torque (a,) [Nm] that brings a robot to rest where it is, and keeps it there.

    tau = s M dv + h with dv = -velocity / BRAKE_TIME, at most max_acceleration, and the largest s
    in [0, 1] that the bounds allow: braking all joints less keeps their motions decoupled, which
    clipping a single torque would not. A joint whose h alone is beyond its bounds is clipped.

    Args:
        dynamics: at the current state.
        velocity: (n,) [rad/s]; the base of a floating one (the first n - a entries) is commanded
            to stay, as far as forces at the contacts can carry it.
        torque_limit: (a,) [Nm], inf where there is none.
        contact_rows: contacts that are on; their forces are the smallest that fit, friction aside.
        previous: (a,) [Nm] torque applied over the last control period.
        torque_step: largest change from `previous` per control period [Nm], a number or (a,); inf
            = no limit.
        max_acceleration: [rad/s^2] of a joint; inf = only the bounds apply.
        lower: (a,) [Nm] at most `torque_limit`; None = -torque_limit.
    """
    base = velocity.shape[0] - torque_limit.shape[0]
    # minimum and maximum take a third of the time of np.clip, for the same numbers.
    acceleration = np.minimum(
        np.maximum(velocity / -BRAKE_TIME, -max_acceleration), max_acceleration
    )
    acceleration[:base] = 0.0
    braking = _of_motors(dynamics.mass_matrix @ acceleration, base, contact_rows)
    bias = _of_motors(dynamics.bias, base, contact_rows)
    least = -torque_limit if lower is None else lower
    lower, upper = least, torque_limit
    if previous is not None:
        # If the last torque is itself outside the limits, the limits take precedence.
        lower = np.minimum(np.maximum(lower, previous - torque_step), upper)
        upper = np.maximum(np.minimum(upper, previous + torque_step), least)
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.where(braking > 0.0, upper - bias, lower - bias) / braking
    room[(braking == 0.0) | (bias < lower) | (bias > upper)] = np.inf
    scale = min(max(float(room.min(initial=np.inf)), 0.0), 1.0)
    torque: Array = np.minimum(np.maximum(scale * braking + bias, lower), upper)
    return torque


def _of_motors(generalized: Array, base: int, contact_rows: ContactRows | None) -> Array:
    """The motors' part (a,) of generalized forces (n,) that motors and contacts exert together."""
    if not base or contact_rows is None:
        return generalized[base:]
    push = contact_rows.force_jacobian.T
    force = np.linalg.lstsq(push[:base], generalized[:base], rcond=1e-9)[0]
    joints: Array = generalized[base:] - push[base:] @ force
    return joints
