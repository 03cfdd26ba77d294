"""Between ROS messages and the controller's values: pure functions, both directions."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence

import numpy as np
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import (
    ControllerState,
    NamedCount,
    PriorityMatrix,
    PriorityTransition,
    TaskReference,
    TaskState,
    TransitionStatus,
)
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState

from ghc_controller.cdr import BYTE_ORDER, NANOSECONDS, numbers_behind_strings
from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.hierarchy import (
    PriorityMatrix as Priorities,
)
from ghc_controller.hierarchy import (
    Profile,
    Transition,
    TransitionEvent,
    TransitionSchedule,
    format_hierarchy,
    matrix_from_hierarchy,
)
from ghc_controller.reference import ReferenceTrajectory
from ghc_controller.report import Report
from ghc_controller.tasks.follower import UNIT_TOLERANCE, Follower
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.types import Array

_POSE, _TWIST = slice(0, 7), slice(43, 49)  # of an Odometry's numbers; covariances between

# Reliable on the publisher so that every reader matches; best effort on the control path, where
# a message that is late is worth less than the next one.
CONTROL_PUBLISHER_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
CONTROL_SUBSCRIBER_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
RELIABLE_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
LATCHED_QOS = QoSProfile(
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
STREAM_QOS = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


def time_from_nanoseconds(stamp_ns: int) -> Time:
    """Stamp [ns] as a message."""
    seconds, nanoseconds = divmod(stamp_ns, NANOSECONDS)
    return Time(sec=seconds, nanosec=nanoseconds)


def nanoseconds_from_time(stamp: Time) -> int:
    """Stamp of a message in [ns]."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def doubles(values: Array) -> array[float]:
    """Entries in row-major order, as a message takes them without a look at each."""
    return array("d", np.ascontiguousarray(values, dtype=np.float64).tobytes())


def time_from_seconds(seconds: float) -> Time:
    """Time [s] as a message, to the nearest nanosecond."""
    return time_from_nanoseconds(round(seconds * NANOSECONDS))


def read_joint_state(data: bytes) -> JointState:
    """Message of its serialized bytes.

    Raises:
        ValueError: the bytes are no JointState.
    """
    try:
        return deserialize_message(data, JointState)
    except Exception as error:  # the middleware's own type, whatever it is
        raise ValueError(f"not a JointState: {error}") from error


def wrench_from_bytes(data: bytes) -> Array:
    """(6,) force [N] and torque [Nm] of a serialized WrenchStamped, in the axes of the message.

    Raises:
        InvalidValue: an entry is not finite, or the bytes are no such message.
    """
    wrench = _numbers(data, WrenchStamped, 1, 6)
    if not np.isfinite(wrench).all():
        raise InvalidValue(f"wrench {wrench.tolist()} given, finite numbers expected")
    return wrench


def base_from_bytes(data: bytes) -> Array:
    """(13,) position [m], unit quaternion x, y, z, w, linear and angular velocity, base axes, of
    a serialized Odometry.

    Raises:
        InvalidValue: an entry is not finite, the quaternion is not of unit length, or the bytes
            are no such message.
    """
    numbers = _numbers(data, Odometry, 2, _TWIST.stop)
    base = np.concatenate([numbers[_POSE], numbers[_TWIST]])
    if not np.isfinite(base).all():
        raise InvalidValue(f"pose and twist {base.tolist()} given, finite numbers expected")
    length = float(np.linalg.norm(base[3:7]))
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise InvalidValue(f"quaternion of length {length:g} given, a unit quaternion expected")
    base[3:7] /= length
    return base


def _numbers(data: bytes, kind: type, strings: int, count: int) -> Array:
    """Numbers of a serialized message of a `kind` that has them right behind its strings."""
    try:
        if not data.startswith(BYTE_ORDER):
            data = bytes(serialize_message(deserialize_message(data, kind)))
        return np.array(numbers_behind_strings(data, strings, count))
    except Exception as error:  # the middleware's own type, whatever it is
        raise InvalidValue(f"no {kind.__name__}: {error}") from error


def transition_from_message(
    message: PriorityTransition, known_tasks: Sequence[str], now: float
) -> Transition:
    """Transition of a request; a zero stamp means `now` [s].

    Raises:
        GhcError: malformed string or matrix, unknown task, bad duration or profile.
    """
    if message.hierarchy and (len(message.tasks) or len(message.alpha)):
        raise InvalidValue(
            f"both hierarchy '{message.hierarchy}' and a matrix of {len(message.tasks)} tasks "
            "given, one of them expected"
        )
    if message.hierarchy:
        target = matrix_from_hierarchy(known_tasks, message.hierarchy)
    else:
        if not message.tasks:
            raise InvalidValue(
                "neither hierarchy nor tasks given; expected a hierarchy such as "
                f"'{' > '.join(known_tasks)}' or tasks with a row-major alpha"
            )
        target = Priorities.from_rows(known_tasks, message.tasks, message.alpha)
    stamp = nanoseconds_from_time(message.header.stamp)
    start = now if stamp == 0 else stamp / NANOSECONDS
    profile = Profile.parse(message.profile)
    return Transition(target, start, message.duration, profile, message.id, message.hierarchy)


def status_message(
    status: int, time: float, transition: Transition | None, request_id: str = "", reason: str = ""
) -> TransitionStatus:
    """Status of a transition; of a request that never became one when it is None."""
    message = TransitionStatus(status=status, id=request_id, reason=reason)
    message.header.stamp = time_from_seconds(time)
    if transition is not None:
        message.id = transition.id
        message.hierarchy = transition.hierarchy or format_hierarchy(transition.target)
        message.start = time_from_seconds(transition.start)
        message.duration = transition.duration
    return message


def event_message(event: TransitionEvent) -> TransitionStatus:
    """Status message of something that happened to an accepted transition."""
    return status_message(
        getattr(TransitionStatus, event.phase.value), event.time, event.transition
    )


def matrix_message(priorities: TransitionSchedule, time: float) -> PriorityMatrix:
    """The matrix in force at `time` [s]."""
    message = PriorityMatrix(tasks=list(priorities.tasks))
    message.header.stamp = time_from_seconds(time)
    message.alpha = np.asarray(priorities.alpha).ravel().tolist()
    message.hierarchy = format_hierarchy(priorities.target)
    message.in_transition = priorities.in_transition
    return message


def reference_from_message(
    message: TaskReference, task: Follower, current: Array, now: float
) -> ReferenceTrajectory:
    """Reference of a task; a zero stamp means `now` [s].

    Args:
        current: target position in force, kept by points that give none.

    Raises:
        GhcError: sizes, values or joint names that do not fit the task.
    """
    if not message.points:
        raise InvalidValue(f"task '{task.name}': no points given, at least one expected")
    order = _joint_order(message, task)
    times = [
        point.time_from_start.sec + point.time_from_start.nanosec / NANOSECONDS
        for point in message.points
    ]
    position = [
        current if not point.position else _row(task, "position", point.position, order)
        for point in message.points
    ]
    stamp = nanoseconds_from_time(message.header.stamp)
    return ReferenceTrajectory.for_task(
        task,
        np.array(times),
        np.array(position),
        _optional_rows(message, task, "velocity", order),
        _optional_rows(message, task, "acceleration", order),
        _optional_rows(message, task, "wrench", order),
        now if stamp == 0 else stamp / NANOSECONDS,
    )


def _joint_order(message: TaskReference, task: Follower) -> list[int] | None:
    """Where the joints of the task stand in the message; None when it names none."""
    if not message.joints:
        return None
    if not isinstance(task, PostureTask):
        raise InvalidValue(f"task '{task.name}' has no joints; joints is for posture tasks only")
    if sorted(message.joints) != sorted(task.labels):
        raise InvalidValue(
            f"task '{task.name}': joints {', '.join(message.joints)} given, "
            f"{', '.join(task.labels)} in any order expected"
        )
    return [list(message.joints).index(joint) for joint in task.labels]


def _row(task: Follower, name: str, values: Sequence[float], order: list[int] | None) -> Array:
    row = np.array(values, dtype=np.float64)
    expected = task.position_size if name == "position" else task.size
    if row.shape != (expected,):
        raise WrongSize(f"task '{task.name}', {name} of a point", len(row), expected)
    return row if order is None else row[order]


def _optional_rows(
    message: TaskReference, task: Follower, name: str, order: list[int] | None
) -> Array | None:
    """(p, m) when any point gives the field, zeros where a point does not; else None."""
    values = [getattr(point, name) for point in message.points]
    if not any(len(value) for value in values):
        return None
    zero = [0.0] * task.size
    return np.array([_row(task, name, value or zero, order) for value in values])


def controller_state_message(
    report: Report, formulation: str, solver: str, joint_names: Sequence[str]
) -> ControllerState:
    """Account of one control step."""
    result, solution = report.result, report.result.solution
    message = ControllerState(formulation=formulation, joint_names=list(joint_names))
    message.header.stamp = time_from_seconds(result.time)
    message.tasks = [
        TaskState(
            name=task.name,
            error=doubles(task.error),
            error_norm=task.motion_error,
            force_error=task.force_error,
            reference=doubles(task.target.position),
        )
        for task in report.tasks
    ]
    message.alpha = doubles(report.alpha)
    message.status = result.status.value
    message.solver = solver if solution.qp_solved else "none"
    message.qp_solved = solution.qp_solved
    message.primal_residual = solution.primal_residual
    message.dual_residual = solution.dual_residual
    message.sigma_min = report.sigma_min
    message.active_constraints = list(report.active_constraints)
    message.slack_names = [slack.name for slack in report.slack]
    message.slack = [slack.amount for slack in report.slack]
    message.fallback_reason = report.fallback_reason
    message.counts = [
        NamedCount(name=name, count=count) for name, count in sorted(report.counts.items())
    ]
    message.torque = doubles(result.torque)
    message.bounded_contacts = list(report.contacts.names)
    message.contact_lower = doubles(report.contacts.lower)
    message.contact_upper = doubles(report.contacts.upper)
    message.contact_forces = doubles(report.contacts.force)
    message.contacts = list(report.loads.names)
    message.normal_forces = doubles(report.loads.normal)
    message.friction_use = doubles(report.loads.friction_use)
    message.time_terms = result.time_terms
    message.time_solve = result.time_solve
    message.time_step = result.time_step
    return message


def diagnostics_message(
    stamp_ns: int,
    node_name: str,
    summary: str,
    warning: bool,
    values: Mapping[str, object],
    hardware_id: str = "",
) -> DiagnosticArray:
    """One status with its values as text."""
    status = DiagnosticStatus(
        level=DiagnosticStatus.WARN if warning else DiagnosticStatus.OK,
        name=node_name,
        message=summary,
        hardware_id=hardware_id,
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )
    message = DiagnosticArray(status=[status])
    message.header.stamp = time_from_nanoseconds(stamp_ns)
    return message
