"""True distances of bodies, by Pinocchio's collision library: what the constraint is judged by."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np

from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.model.rounded_shape import Shape
from ghc_controller.types import Array


class Judge:
    """Distances of all pairs of a constraint, from a model of its own."""

    def __init__(self, constraint: BodyDistance, model: RobotModel) -> None:
        """`model`: the same robot, not that of the controller."""
        self._model = model
        self._pairs = constraint.pairs
        self._bodies = {
            name: [(*_coal(shape), body.frame) for shape in body.shapes]
            for name, body in constraint.bodies.items()
        }
        for body in constraint.bodies.values():
            if body.frame:
                model.frame_id(body.frame)

    def distances(self, q: Array) -> Array:
        """(p,) [m] of the pairs of the constraint at configuration q (nq,)."""
        self._model.update(q, np.zeros(self._model.nv))
        placed = {
            name: [(core, self._place(place, frame), radius) for core, place, radius, frame in own]
            for name, own in self._bodies.items()
        }
        return np.array([_least(placed[a], placed[b]) for a, b in self._pairs])

    def _place(self, local: coal.Transform3s, frame: str) -> coal.Transform3s:
        if not frame:
            return local
        number = self._model.frame_id(frame)
        rotation = self._model.frame_rotation(number).copy()
        return coal.Transform3s(rotation, self._model.frame_position(number).copy()) * local


def _least(first: list[Any], second: list[Any]) -> float:
    request = coal.DistanceRequest()
    return min(
        coal.distance(a, at_a, b, at_b, request, coal.DistanceResult()) - r_a - r_b
        for a, at_a, r_a in first
        for b, at_b, r_b in second
    )


def _coal(shape: Shape) -> tuple[Any, coal.Transform3s, float]:
    """Geometry and place of a shape, and what is left of its radius."""
    count = shape.axes.shape[1]
    if count == 0:
        return coal.Sphere(shape.radius), coal.Transform3s(np.eye(3), shape.center), 0.0
    lengths = np.linalg.norm(shape.axes, axis=0)
    if count == 3:
        place = coal.Transform3s(shape.axes / lengths, shape.center)
        return coal.Box(*(2.0 * lengths)), place, shape.radius
    other = np.linalg.qr(np.column_stack([shape.axes[:, 0] / lengths[0], np.eye(3)]))[0]
    turn = np.column_stack([other[:, 1], other[:, 2], shape.axes[:, 0] / lengths[0]])
    turn[:, 0] *= np.sign(np.linalg.det(turn))
    return coal.Capsule(shape.radius, 2.0 * lengths[0]), coal.Transform3s(turn, shape.center), 0.0
