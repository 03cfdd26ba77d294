"""From what is scripted to messages."""

from __future__ import annotations

from dataclasses import dataclass

from builtin_interfaces.msg import Duration, Time
from ghc_msgs.msg import ContactSchedule, PriorityTransition, TaskReference, TaskReferencePoint

from ghc_sim_bridge.scenario.references import Reference, ReferencePoint
from ghc_sim_bridge.scenario.scenario import PriorityTable
from ghc_sim_bridge.scenario.schedules import ScriptedSchedule


@dataclass(frozen=True, slots=True)
class ScriptedTransition:
    """A transition with its simulated start."""

    id: str
    start: float  # [s]
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


def transition_message(transition: ScriptedTransition) -> PriorityTransition:
    """A transition with its simulated start."""
    message = PriorityTransition()
    message.header.stamp = to_stamp(transition.start)
    message.id = transition.id
    message.duration = transition.duration
    message.torque_rate = transition.torque_rate
    if transition.table is None:
        message.hierarchy = transition.hierarchy
    else:
        message.tasks = list(transition.table.tasks)
        message.alpha = [entry for row in transition.table.alpha for entry in row]
    return message


def schedule_message(schedule: ScriptedSchedule) -> ContactSchedule:
    """What one contact may carry, at simulated times."""
    message = ContactSchedule(contact=schedule.contact)
    message.header.stamp = Time(nanosec=1)  # as good as zero, which would mean: on receipt
    message.known_from = to_stamp(schedule.known_from)
    message.times = list(schedule.times)
    message.lower, message.upper = list(schedule.lower), list(schedule.upper)
    return message


def to_stamp(seconds: float) -> Time:
    """Time message of simulated seconds, exact to a nanosecond."""
    nanoseconds = round(seconds * 1e9)
    return Time(sec=nanoseconds // 1_000_000_000, nanosec=nanoseconds % 1_000_000_000)


def to_seconds(stamp: Time) -> float:
    """Simulated seconds of a time message."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def _point(point: ReferencePoint) -> TaskReferencePoint:
    stamp = to_stamp(point.time)
    return TaskReferencePoint(
        time_from_start=Duration(sec=stamp.sec, nanosec=stamp.nanosec),
        position=list(point.position),
        velocity=list(point.velocity),
        acceleration=list(point.acceleration),
        wrench=list(point.wrench),
    )
