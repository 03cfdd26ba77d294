"""What obstacles that move add to distances and to their derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.model.rounded_shape import Shape
from ghc_controller.types import Array

PENALTY = 3e-3  # [-] e of `core/constraints/body_pairs.hpp`
LONGEST = 0.1  # [m] L there
_TINY = 1e-12  # [m^2] axis of no length
WORLD = -1  # frame of a shape that no joint moves


class Placed(NamedTuple):
    """A shape and what it is fixed to."""

    shape: Shape
    frame: int  # handle of `RobotModel.frame_id`, or WORLD


class Side(NamedTuple):
    """One of two shapes: where it is now, and how its closest point moves at fixed u."""

    center: Array  # (3,) [m] in the world
    axes: Array  # (3, 3) [m]
    turning: Array  # (3, 3) [m/s] of the axes
    velocity: Array  # (3,) [m/s] of the closest point

    @classmethod
    def of(cls, model: RobotModel, placed: Placed, u: Array) -> Side:
        """Of a shape on a link, at places u (3,) along its axes; one in the world rests."""
        axes = np.zeros((3, 3))
        axes[:, : placed.shape.axes.shape[1]] = placed.shape.axes
        if placed.frame == WORLD:
            return cls(placed.shape.center, axes, np.zeros((3, 3)), np.zeros(3))
        frame = model.frame(placed.frame)
        axes, arm = frame.rotation @ axes, frame.rotation @ placed.shape.center
        turn = frame.velocity[3:]
        velocity = frame.velocity[:3] + np.cross(turn, arm + axes @ u)
        return cls(frame.position + arm, axes, np.cross(turn, axes, axisb=0, axisc=0), velocity)


def penalties(axes: Array) -> Array:
    """(3,) [m^2] e l_k^2 of the axes (3, 3) of a shape."""
    squares = np.sum(axes * axes, axis=0)
    box = np.count_nonzero(squares > _TINY) > 1
    return np.asarray(PENALTY * (np.minimum(squares, LONGEST**2) if box else squares))


def added_motion(
    first: Side, second: Side, u: Array, length: float, rate: float, moves: Array
) -> tuple[float, float]:
    """What d' [m/s] and the drift [m/s^2] of a distance gain where shapes also translate.

    With s, a the velocity and acceleration that the vector p between the cores gains, its speed
    p' before, and B, g, H as in docs/body_distances.md:

        d' grows by p.s / |p|,
        |p| drift by p.a + 2 s.p' + |s|^2 - (2 g + B^T s)^T H^-1 B^T s - d'^2 (after - before).

    Args:
        u: (6,) places of the closest points, of the second shape and of the first.
        length: [m] |p|, with the penalty's share.
        rate: [m/s] d' without.
        moves: (2, 3) s and a.
    """
    s, a = moves
    axes = np.hstack([second.axes, -first.axes])
    turning = np.hstack([second.turning, -first.turning])
    gap = second.center - first.center + axes @ u
    speed = second.velocity - first.velocity
    hessian = axes.T @ axes
    free = np.flatnonzero((np.diag(hessian) > _TINY) & (np.abs(u) < 1.0))
    penalty = np.concatenate([penalties(second.axes), penalties(first.axes)])
    hessian = hessian[np.ix_(free, free)] + np.diag(penalty[free])
    pull = (axes.T @ speed + turning.T @ gap)[free]
    more = (axes.T @ s)[free]
    sliding = float((2.0 * pull + more) @ np.linalg.solve(hessian, more))
    faster = float(gap @ s) / length
    curvature = float(gap @ a + 2.0 * speed @ s + s @ s) - sliding
    return faster, (curvature - (2.0 * rate + faster) * faster) / length
