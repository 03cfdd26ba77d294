"""From what is scripted to messages."""

from __future__ import annotations

from dataclasses import dataclass

from builtin_interfaces.msg import Duration
from ghc_msgs.msg import PriorityTransition, TaskReference, TaskReferencePoint

from ghc_controller.ros.time import time_from_seconds
from ghc_sim_bridge.scenario.phase import PriorityTable
from ghc_sim_bridge.scenario.references import Reference, ReferencePoint


@dataclass(frozen=True, slots=True)
class ScriptedTransition:
    """A transition with its start."""

    id: str
    start: float  # [s] of the run
    duration: float  # [s]
    torque_rate: float = 0.0  # [Nm/s] budget; 0 = none
    hierarchy: str = ""
    table: PriorityTable | None = None  # used in place of the string


def reference_message(reference: Reference, duration: float) -> TaskReference:
    """Reference of one task for a run of `duration` [s], stamped with time zero."""
    message = TaskReference()
    message.task = reference.task
    message.joints = list(reference.joints)
    message.points = [_point(point) for point in reference.points_until(duration)]
    return message


def transition_message(transition: ScriptedTransition, run_start: float) -> PriorityTransition:
    """A transition of a run that begins at `run_start` [s] of simulated time."""
    message = PriorityTransition()
    message.header.stamp = time_from_seconds(run_start + transition.start)
    message.id = transition.id
    message.duration = transition.duration
    message.torque_rate = transition.torque_rate
    if transition.table is None:
        message.hierarchy = transition.hierarchy
    else:
        message.tasks = list(transition.table.tasks)
        message.alpha = [entry for row in transition.table.alpha for entry in row]
    return message


def _point(point: ReferencePoint) -> TaskReferencePoint:
    stamp = time_from_seconds(point.time)
    return TaskReferencePoint(
        time_from_start=Duration(sec=stamp.sec, nanosec=stamp.nanosec),
        position=list(point.position),
        velocity=list(point.velocity),
        acceleration=list(point.acceleration),
        wrench=list(point.wrench),
    )
