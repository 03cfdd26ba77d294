"""Previews of the constraint generators: from messages to values and back."""

from __future__ import annotations

import math

import numpy as np
from ghc_msgs.msg import ConstraintPreview, ConstraintPreviews, PlannedMotion

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.previews.motion import PlannedMotion as Motion
from ghc_controller.previews.preview import Preview, StaleRule
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.report.report import ObstacleReport
from ghc_controller.ros.conversions.common import doubles
from ghc_controller.ros.time import time_from_nanoseconds
from ghc_controller.types import UNIT_TOLERANCE, Array

SHORTEST_STEP, LONGEST_STEP = 1e-6, 10.0  # [s] between two points of a preview
MOST_POINTS = 100_000  # [-]
# Largest values of a planned obstacle along one axis.
FARTHEST, FASTEST, SHARPEST, JERKIEST = 100.0, 20.0, 1e3, 1e6  # [m], [m/s], [m/s^2], [m/s^3]


def preview_from_message(message: ConstraintPreview, start: float) -> Preview:
    """Preview of a message; `start` [s] is the stamp of all of one tick.

    Raises:
        GhcError: sizes that do not fit together, entries that are not finite, a step out of
            range, a normal that is not of unit length, an unknown status or stale rule.
    """
    step, points = _checked_step(message.step), int(message.points)
    if not 2 <= points <= MOST_POINTS:
        raise InvalidValue(f"points: {points} given, 2 to {MOST_POINTS} expected")
    stale = _stale_rule(message.stale_rule)
    if message.motions:
        motions = tuple(_motion(entry, points - 1) for entry in message.motions)
        moving = Preview.of_motions(start, step, points - 1, motions)
        return moving.labeled(message.kind, stale, message.name)
    count = len(message.rows)
    for name in ("active", "conflict", "status"):
        if len(getattr(message, name)) != count:
            raise WrongSize(f"{message.kind}, {name}", len(getattr(message, name)), count)
    return Preview(
        message.kind,
        start,
        step,
        tuple(message.rows),
        _bounds(message, "lower"),
        _bounds(message, "upper"),
        tuple(message.active),
        tuple(_status(value, message.kind) for value in message.status),
        tuple(message.conflict),
        message.interpolate,
        (),
        stale,
        message.name,
    )


def previews_message(
    previews: tuple[Preview, ...], start_ns: int, epoch: int
) -> ConstraintPreviews:
    """Message with the previews of one generator at a tick [ns]."""
    message = ConstraintPreviews(epoch=epoch)
    message.header.stamp = time_from_nanoseconds(start_ns)
    message.previews = [_preview_message(preview) for preview in previews]
    return message


def obstacle_message(report: ObstacleReport) -> PlannedMotion:
    """A virtual obstacle as used in a control step; the jerk is left empty."""
    return _motion_message(report.planned, report.state, report.planned.jerk[:0])


def motion_state(entry: PlannedMotion) -> Array:
    """(3, 3) rows: position, velocity, acceleration."""
    rows = [entry.position, entry.velocity, entry.acceleration]
    return np.array([list(row) for row in rows], dtype=np.float64)


def _preview_message(preview: Preview) -> ConstraintPreview:
    message = ConstraintPreview(kind=preview.kind, name=preview.name, step=preview.step)
    message.points, message.interpolate = preview.lower.shape[1], preview.interpolate
    message.stale_rule = preview.stale.value
    if preview.motions:
        message.motions = [
            _motion_message(motion, motion.state, motion.jerk) for motion in preview.motions
        ]
        return message
    message.rows = list(preview.rows)
    message.lower, message.upper = doubles(preview.lower), doubles(preview.upper)
    message.active, message.conflict = list(preview.active), list(preview.conflict)
    message.status = [status.value for status in preview.status]
    return message


def _motion_message(motion: Motion, state: Array, jerk: Array) -> PlannedMotion:
    entry = PlannedMotion(id=motion.id, protected_frame=motion.frame, status=motion.status.value)
    entry.safe_distance = float(motion.safe_distance)
    entry.normal[:] = motion.normal
    entry.position[:], entry.velocity[:], entry.acceleration[:] = state
    entry.jerk = doubles(jerk)
    return entry


def _checked_step(step: float) -> float:
    """The step [s] of a preview; InvalidValue if it is NaN or out of range."""
    if not SHORTEST_STEP <= step <= LONGEST_STEP:
        raise InvalidValue(
            f"step {step:g} s given, {SHORTEST_STEP:g} to {LONGEST_STEP:g} s expected"
        )
    return step


def _bounds(message: ConstraintPreview, name: str) -> Array:
    """(r, p) lower or upper bounds; GhcError for wrong sizes or entries that are not finite."""
    count, points = len(message.rows), int(message.points)
    values = np.array(getattr(message, name), dtype=np.float64)
    if values.shape != (count * points,):
        raise WrongSize(f"{message.kind}, {name}", len(values), f"{count} * {points}")
    if not np.isfinite(values).all():
        bad = values[~np.isfinite(values)][0]
        raise InvalidValue(f"{message.kind}, {name}: {bad} given, finite numbers expected")
    return values.reshape(count, points)


def _status(value: int, where: str) -> PreviewStatus:
    """The status with this value; InvalidValue when there is none."""
    try:
        return PreviewStatus(int(value))
    except ValueError as error:
        known = ", ".join(f"{status.value} ({status.name})" for status in PreviewStatus)
        raise InvalidValue(f"{where}: status {value} given; known: {known}") from error


def _stale_rule(value: int) -> StaleRule:
    try:
        return StaleRule(int(value))
    except ValueError as error:
        known = ", ".join(f"{rule.value} ({rule.name})" for rule in StaleRule)
        raise InvalidValue(f"stale_rule {value} given; known: {known}") from error


def _motion(entry: PlannedMotion, steps: int) -> Motion:
    """One obstacle of a preview with `steps` steps; GhcError as in preview_from_message."""
    where = f"obstacle '{entry.id}'"
    normal, state = np.array(entry.normal, dtype=np.float64), motion_state(entry)
    jerk = np.array(entry.jerk, dtype=np.float64)
    if len(jerk) % 3:
        raise WrongSize(f"{where}, jerk", len(jerk), "a multiple of 3")
    if len(jerk) > 3 * steps:
        raise WrongSize(f"{where}, jerk", len(jerk), f"at most 3 * {steps}")
    if not (np.isfinite(jerk).all() and np.isfinite(state).all()):
        raise InvalidValue(
            f"{where}: position {entry.position.tolist()}, velocity {entry.velocity.tolist()}, "
            f"acceleration {entry.acceleration.tolist()} and a jerk of {len(jerk)} numbers given, "
            "finite numbers expected"
        )
    if not (math.isfinite(entry.safe_distance) and entry.safe_distance >= 0.0):
        raise InvalidValue(
            f"{where}: safe_distance {entry.safe_distance:g} m given, 0 or more expected"
        )
    for what, values, most in (
        ("position", state[0], FARTHEST),
        ("velocity", state[1], FASTEST),
        ("acceleration", state[2], SHARPEST),
        ("jerk", jerk, JERKIEST),
        ("safe_distance", np.array([entry.safe_distance]), FARTHEST),
    ):
        largest = float(np.abs(values).max(initial=0.0))
        if largest > most:
            raise InvalidValue(f"{where}, {what}: {largest:g} given, at most {most:g} expected")
    length = float(np.linalg.norm(normal))
    if not abs(length - 1.0) <= UNIT_TOLERANCE:  # also true for NaN
        raise InvalidValue(f"{where}: normal of length {length:g} given, 1 expected")
    return Motion(
        entry.id,
        entry.protected_frame,
        entry.safe_distance,
        normal,
        state,
        jerk.reshape(-1, 3),
        _status(entry.status, where),
    )
