"""A sliding contact: free along the tangents, with or without kinetic friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.contacts.contact import Contact
from ghc_controller.contacts.registry import register_contact
from ghc_controller.core import write_force_map
from ghc_controller.model.frames import FrameTerms
from ghc_controller.types import Array

_SLIDES = 0.01  # [m/s] friction fades to zero below this speed, where its direction is undefined


@register_contact("sliding")
@dataclass(frozen=True, slots=True, eq=False)
class SlidingContact(Contact):
    """Each point stays on its plane; `friction` is kinetic and acts against the motion.

    The force at a point that moves with v_t along the plane is f (n - mu v_t / |v_t|), f >= 0:
    a single coordinate, since friction follows from the motion and cannot hold the point.
    """

    @property
    def force_axes(self) -> Array:
        """The normal (1, 3)."""
        return self.axes[2:]

    def write_forces(self, frame: FrameTerms, jacobian: Array) -> None:
        """One row per point, along normal and friction."""
        normal = self.axes[2]
        for p, point in enumerate(self.points):
            velocity = frame.velocity[:3] + np.cross(frame.velocity[3:], frame.rotation @ point)
            along = velocity - (normal @ velocity) * normal
            speed = max(float(np.linalg.norm(along)), _SLIDES)
            axis = normal - self.friction / speed * along
            write_force_map(
                frame.rotation,
                frame.jacobian,
                self.points[p : p + 1],
                axis.reshape(1, 3),
                jacobian[p : p + 1],
            )

    def write_motion(self, frame: FrameTerms, jacobian: Array, target: Array) -> None:
        """The motion along the normal, without friction."""
        super(SlidingContact, self).write_motion(frame, jacobian, target)
        write_force_map(frame.rotation, frame.jacobian, self.points, self.force_axes, jacobian)
