"""What the compiled core needs of a pin.Model: one row of numbers for each joint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ghc_controller.core import Model
from ghc_controller.errors import ConfigurationError
from ghc_controller.model.structure import has_floating_base
from ghc_controller.types import Array

_SAME = 1e-12  # between entries of two poses
_PROBES = (0.0, 0.7, -1.3)  # positions at which a joint is compared with its one axis


def make_core(model: pin.Model) -> Model:
    """The tree of joints, each turned so that its axis is the z axis of its frame.

    Raises:
        ConfigurationError: a joint that is no turn about and no slide along one axis, by its kind.
    """
    floating = has_floating_base(model)
    joints = [_FIXED, *(_Joint.of(model, j, floating) for j in range(1, model.njoints))]
    table = [_row(model, j, joints) for j in range(1, model.njoints)]
    parents = [int(parent) - 1 for parent in list(model.parents)[1:]]
    return Model(
        parents,
        np.array(table),
        floating,
        np.array(model.gravity.linear),
        np.array(model.armature),
    )


def add_frame(core: Model, model: pin.Model, pin_frame: int) -> int:
    """Number of a new frame of the core."""
    frame = model.frames[pin_frame]
    joint = int(frame.parentJoint)
    place, turn = frame.placement, np.eye(3)
    if joint > 0:
        turn = _Joint.of(model, joint, has_floating_base(model)).turn
    return core.add_frame(
        joint - 1, np.ascontiguousarray(turn.T @ place.rotation), turn.T @ place.translation
    )


@dataclass(frozen=True, slots=True)
class _Joint:
    """How a joint moves: along and about the z axis of its turned frame."""

    turn: Array  # (3, 3) takes z to its axis; of a floating base the identity
    slide: float = 0.0  # of one unit of q
    spin: float = 0.0

    @classmethod
    def of(cls, model: pin.Model, joint: int, floating: bool) -> _Joint:
        if floating and joint == 1:
            return _FIXED
        axis, slide, spin = _axis(model, joint)
        return cls(_turn_to_z(axis), slide, spin)


_FIXED = _Joint(np.eye(3))


def _row(model: pin.Model, joint: int, joints: Sequence[_Joint]) -> Array:
    place, body = model.jointPlacements[joint], model.inertias[joint]
    above, own = joints[int(model.parents[joint])].turn, joints[joint]
    turn = own.turn
    return np.concatenate(
        [
            (above.T @ place.rotation @ turn).ravel(),
            above.T @ place.translation,
            [own.spin, own.slide, body.mass],
            turn.T @ body.lever,
            (turn.T @ body.inertia @ turn).ravel(),
        ]
    )


def _turn_to_z(axis: Array) -> Array:
    """Rotation (3, 3) that takes z to a unit axis (3,)."""
    across = np.eye(3)[int(np.argmin(np.abs(axis)))]
    x = _cross(across, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, _cross(axis, x), axis])


def _cross(a: Array, b: Array) -> Array:
    """Cross product (3,); numpy's takes ten times as long for one pair."""
    (a0, a1, a2), (b0, b1, b2) = a, b
    return np.array([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0])


def _axis(model: pin.Model, joint: int) -> tuple[Array, float, float]:
    """Unit axis (3,), slide along it and turn about it of one unit of q."""
    kind = model.joints[joint]
    data = kind.createData()
    kind.calc(data, np.zeros(model.nq))
    motion = np.asarray(data.S).ravel()
    linear, angular = motion[:3], motion[3:]
    spin, slide = float(np.linalg.norm(angular)), float(np.linalg.norm(linear))
    axis = angular / spin if spin > 0.0 else linear / max(slide, 1e-300)
    slide = float(axis @ linear)
    for probe in _PROBES:
        q = np.full(model.nq, probe)
        kind.calc(data, q)
        wanted = pin.exp6(pin.Motion(probe * slide * axis, probe * spin * axis)).homogeneous
        if not np.abs(np.array(data.M) - wanted).max() <= _SAME:  # NaN is not the same either
            raise ConfigurationError(
                f"joint '{model.names[joint]}' is a {kind.shortname()}: a turn about one axis or "
                "a slide along one expected"
            )
    return axis, slide, spin
