"""A robot at one state, as a value: placements, Jacobians and dynamics that never change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.model.frames import FrameTerms
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array, Dynamics


@dataclass(frozen=True, slots=True, eq=False)
class Configuration:
    """State q, v of a robot and what follows from it, computed once; all arrays are read-only.

    `Robot.at` makes the first one. Where RobotModel has one state that every `update` overwrites,
    `update` and `moved` of this class give a new value and leave this one as it is.

    n = number of velocity coordinates, a = actuated joints; coordinates as in RobotModel.
    """

    q: Array  # (nq,) [rad], [m]
    v: Array  # (n,) [rad/s], [m/s]
    dynamics: Dynamics  # M (n, n) and h (n,)
    gravity: Array  # (n,) torque that holds the robot still [Nm], [N]
    center_of_mass: Array  # (3,) in the world [m]
    center_of_mass_jacobian: Array  # (3, n)
    frames: Mapping[str, FrameTerms]  # of every link, by its name
    joint_names: tuple[str, ...]  # (a,) the last entries of q and v
    # Computes the values of one robot, which share it: not for several threads at once.
    _model: RobotModel = field(repr=False)

    @classmethod
    def of(cls, model: RobotModel, q: ArrayLike, v: ArrayLike | None = None) -> Configuration:
        """The robot of a model at q (nq,) and v (n,), at rest without v; the model is not changed.

        Raises:
            WrongSize: q or v has another shape.
            InvalidValue: a value is not finite.
        """
        own = model.copy()
        for name in own.frame_names:
            own.frame_id(name)
        return _computed(own, q, v)

    def frame(self, name: str) -> FrameTerms:
        """Placement, Jacobian, velocity and drift of a link.

        Raises:
            UnknownName: no link of that name; lists those that exist.
        """
        if name not in self.frames:
            raise UnknownName("frame", name, self.frames)
        return self.frames[name]

    def update(self, q: ArrayLike, v: ArrayLike | None = None) -> Configuration:
        """The same robot at another state; raises as `of` does."""
        return _computed(self._model, q, v)

    def moved(self, velocity: ArrayLike, duration: float = 1.0) -> Configuration:
        """The same robot after moving at a velocity (n,) for a duration [s], with that velocity.

        Raises:
            WrongSize, InvalidValue: see `of`.
        """
        v = np.asarray(velocity, dtype=np.float64)
        if v.shape != self.v.shape:
            raise WrongSize("velocity", v.shape, self.v.shape)
        return _computed(self._model, self._model.integrate(self.q, duration * v), v)

    @property
    def outside_limits(self) -> tuple[str, ...]:
        """Names of the joints beyond a position limit."""
        angles = self.q[-len(self.joint_names) :]
        limits = self._model.limits
        outside = (angles < limits.position_lower) | (angles > limits.position_upper)
        return tuple(n for n, out in zip(self.joint_names, outside, strict=True) if out)


def _computed(model: RobotModel, q: ArrayLike, v: ArrayLike | None) -> Configuration:
    q = np.array(q, dtype=np.float64)
    v = np.zeros(model.nv) if v is None else np.array(v, dtype=np.float64)
    if not (np.isfinite(q).all() and np.isfinite(v).all()):
        raise InvalidValue("a configuration with a number that is not finite given")
    dynamics = model.update(q, v)
    frames = {name: _kept(model.frame(model.frame_id(name))) for name in model.frame_names}
    return Configuration(
        _frozen(q),
        _frozen(v),
        Dynamics(_frozen(dynamics.mass_matrix), _frozen(dynamics.bias)),
        _frozen(model.gravity()),
        _frozen(model.center_of_mass()),
        _frozen(model.center_of_mass_jacobian()),
        MappingProxyType(frames),
        model.joint_names,
        model,
    )


def _kept(terms: FrameTerms) -> FrameTerms:
    return FrameTerms(
        _frozen(terms.position),
        _frozen(terms.rotation),
        _frozen(terms.jacobian),
        _frozen(terms.velocity),
        _frozen(terms.drift),
    )


def _frozen(values: Array) -> Array:
    """A copy that cannot be written to."""
    values = np.array(values)
    values.flags.writeable = False
    return values
