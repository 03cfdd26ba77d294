"""How the torque rate is shared among the joints, compiled.

n velocity coordinates, a joints, u = n - a coordinates of a floating base, q contact rows.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.numerics.small_factors import cholesky, solve_factored
from ghc_controller.types import Array

_STIFFNESS = 1e4  # [-] of a contact, over the largest inertia of the base
_LEAST_LEFT = 0.1  # [-] of the rate that is planned with, however fast the dynamics change


@njit(cache=True)
def base_follows(mass: Array, contacts: Array, joints: int) -> Array:  # pragma: no cover
    """G (a, n) = [B^T, 1], where the base follows the joints by x_b = B x_j.

    B minimizes x^T (M + s J^T J) x of each joint's motion: rows J (q, n) of contacts that are on
    keep their points, as far as one joint alone can; without them the base is free. The torques
    of a generalized force w (n,) that the base does not take up by itself are G w.
    """
    u = mass.shape[0] - joints
    carried = np.zeros((joints, u + joints))
    for i in range(joints):
        carried[i, u + i] = 1.0
    if u == 0:
        return carried
    base = mass[:u].copy()
    stiffness = 0.0
    for i in range(u):
        stiffness = max(stiffness, _STIFFNESS * mass[i, i])
    for row in range(contacts.shape[0]):
        for i in range(u):
            share = stiffness * contacts[row, i]
            for k in range(u + joints):
                base[i, k] += share * contacts[row, k]
    factor = cholesky(np.ascontiguousarray(base[:, :u]))
    for i in range(joints):
        carried[i, :u] = -solve_factored(factor, base[:, u + i].copy())
    return carried


@njit(cache=True)
def share_rate(
    mass: Array, carried: Array, drift: Array, rate: Array, jerk: Array
) -> float:  # pragma: no cover
    """Write j_k = kappa r_k / T_kk (a,) with the largest kappa for which |T| j <= r - |drift|.

    T = G M G^T (a, a) is the inertia of the joints with the base following; G = carried (a, n),
    drift and rate (a,) [Nm/s].

    Returns:
        kappa.
    """
    joints = rate.shape[0]
    moved = carried @ mass
    inertia = moved @ np.ascontiguousarray(carried.T)
    for k in range(joints):
        jerk[k] = rate[k] / inertia[k, k]
    kappa = np.inf
    for i in range(joints):
        load = 0.0
        for k in range(joints):
            load += abs(inertia[i, k]) * jerk[k]
        kappa = min(kappa, max(rate[i] - drift[i], _LEAST_LEFT * rate[i]) / load)
    for k in range(joints):
        jerk[k] *= kappa
    return kappa
