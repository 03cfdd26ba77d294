"""The experiment as a client on the public topics: references, transitions, pause, progress."""

from __future__ import annotations

from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import (
    ConstraintPreviews,
    ControllerState,
    Epoch,
    PriorityMatrix,
    PriorityTransition,
    TaskReference,
    TransitionStatus,
)
from rclpy.context import Context
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from std_srvs.srv import SetBool

from ghc_controller.errors import GhcError
from ghc_controller.ros.previews import PREVIEW_TOPIC
from ghc_controller.ros.qos import (
    CONTROL_SUBSCRIBER_QOS,
    LATCHED_QOS,
    PREVIEW_SUBSCRIBER_QOS,
    RELIABLE_QOS,
    SCHEDULE_QOS,
    TRACE_QOS,
)
from ghc_controller.ros.time import seconds_from_time
from ghc_controller.ros.wire.epochs import EPOCH_TOPIC
from ghc_mpc_constraints.ros.conversions import schedule_message
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule
from ghc_sim_bridge.logs.controller_trace import ControllerTrace
from ghc_sim_bridge.ros.experiment_conversions import (
    ScriptedTransition,
    reference_message,
    transition_message,
)
from ghc_sim_bridge.scenario.references import Reference

STATE_TOPIC = "joint_states"
TICK_TOPIC = "ghc/tick"
REPORT_TOPIC = "ghc/controller_state"
REFERENCE_TOPIC = "ghc/task_reference"
TRANSITION_TOPIC = "ghc/priority_transition"


class TransitionRejected(GhcError):
    """The controller rejected a scripted transition; the message holds its reason."""


class ExperimentClient(Node):
    """Publishes scripted messages and stores the controller's replies; makes no decisions."""

    def __init__(self, context: Context) -> None:
        super().__init__("experiment", context=context)
        self.trace = ControllerTrace()
        self.statuses: dict[str, TransitionStatus] = {}  # id -> latest answer
        self.accepted: set[str] = set()
        self.controller_spoke = False
        self.run_start: float | None = None  # [s] stamp of the first state of the run
        self.state_time: float | None = None  # [s] of the run, latest joint state, while watched
        self.diagnostics: dict[str, dict[str, str]] = {}  # node -> its latest values
        self.planned_rows: set[str] = set()  # of the previews seen before time runs
        self._states: Subscription | None = None
        self._schedules: dict[str, Publisher] = {}  # topic -> publisher
        self._references = self.create_publisher(TaskReference, REFERENCE_TOPIC, RELIABLE_QOS)
        self._transitions = self.create_publisher(
            PriorityTransition, TRANSITION_TOPIC, RELIABLE_QOS
        )
        self._pause = self.create_client(SetBool, "sim_bridge/pause")
        self.create_subscription(Epoch, EPOCH_TOPIC, self._on_epoch, LATCHED_QOS)
        self.create_subscription(
            TransitionStatus, "ghc/transition_status", self._on_status, RELIABLE_QOS
        )
        self.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)
        self._previews = self.create_subscription(
            ConstraintPreviews, PREVIEW_TOPIC, self._on_previews, PREVIEW_SUBSCRIBER_QOS
        )
        self._matrices = self.create_subscription(
            PriorityMatrix, "ghc/priority_matrix", self._on_matrix, LATCHED_QOS
        )
        self.create_subscription(
            ControllerState, REPORT_TOPIC, self._on_controller_state, TRACE_QOS
        )

    def watch_states(self, watch: bool) -> None:
        """Start or stop reading the joint states: at 1 kHz this has a cost."""
        if watch and self._states is None:
            self._states = self.create_subscription(
                JointState, STATE_TOPIC, self._on_state, CONTROL_SUBSCRIBER_QOS
            )
        elif not watch and self._states is not None:
            self.destroy_subscription(self._states)
            self._states = None

    def stop_waiting_for_controller(self) -> None:
        """Unsubscribe from the latched topic that showed the controller's start."""
        self.destroy_subscription(self._matrices)

    def is_read_by(self, node: str, topic: str) -> bool:
        """Whether a node subscribes to a topic."""
        readers = self.get_subscriptions_info_by_topic(topic)
        return any(reader.node_name == node for reader in readers)

    def publish_reference(self, reference: Reference, duration: float) -> None:
        """Send the reference of one task for a run of `duration` [s], stamped with time zero."""
        self._references.publish(reference_message(reference, duration))

    def publish_transition(self, transition: ScriptedTransition) -> None:
        """Send one transition; the answer comes by `raise_if_rejected` and `accepted`."""
        self._transitions.publish(transition_message(transition, self.run_start or 0.0))

    def publish_schedule(self, topic: str, schedule: LimitSchedule) -> None:
        """Send the schedule of one contact or joint, in times of the run."""
        message = schedule_message(schedule, self.run_start or 0.0)
        if topic not in self._schedules:
            self._schedules[topic] = self.create_publisher(type(message), topic, SCHEDULE_QOS)
        self._schedules[topic].publish(message)

    def schedules_judged(self, generator: str, topic: str) -> int:
        """Number of schedules that a generator has accepted or rejected, from its diagnostics."""
        values = self.diagnostics.get(generator, {})
        return int(values.get("schedules", 0)) + self.schedules_rejected(generator, topic)

    def schedules_rejected(self, generator: str, topic: str) -> int:
        """Number of rejected ones."""
        return int(self.diagnostics.get(generator, {}).get(f"rejected_{topic}", 0))

    def raise_if_rejected(self) -> None:
        """Raise TransitionRejected with the controller's reason, if it rejected one."""
        for status in self.statuses.values():
            if status.status == TransitionStatus.REJECTED:
                raise TransitionRejected(
                    f"transition '{status.id}' was rejected by the controller: {status.reason}"
                )

    @property
    def pause_service_ready(self) -> bool:
        """Whether the bridge offers its pause service."""
        return self._pause.service_is_ready()

    def resume(self) -> Future:
        """Request the bridge to start time; previews are no longer read."""
        self.destroy_subscription(self._previews)
        return self._pause.call_async(SetBool.Request(data=False))

    def _on_status(self, message: TransitionStatus) -> None:
        self.statuses[message.id] = message
        if message.status != TransitionStatus.REJECTED:
            self.accepted.add(message.id)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.diagnostics[status.name] = {pair.key: pair.value for pair in status.values}

    def _on_previews(self, message: ConstraintPreviews) -> None:
        for preview in message.previews:
            self.planned_rows |= set(preview.rows)

    def _on_matrix(self, _message: PriorityMatrix) -> None:
        self.controller_spoke = True

    def _on_epoch(self, message: Epoch) -> None:
        self.run_start = seconds_from_time(message.start)
        self.state_time = None

    def _time_of(self, header: Header) -> float | None:
        """Time of the run [s]; None for earlier stamps, or before the run is known."""
        if self.run_start is None:
            return None
        time = seconds_from_time(header.stamp) - self.run_start
        return time if time >= 0.0 else None

    def _on_state(self, message: JointState) -> None:
        self.state_time = self._time_of(message.header)

    def _on_controller_state(self, message: ControllerState) -> None:
        trace = self.trace
        time = self._time_of(message.header)
        if time is None or (trace.time and time <= trace.time[-1]):
            return
        trace.tasks = tuple(task.name for task in message.tasks)
        trace.time.append(time)
        trace.alpha.append(list(message.alpha))
        trace.errors.append([task.error_norm for task in message.tasks])
        trace.references.append([list(task.reference) for task in message.tasks])
        trace.time_terms.append(message.time_terms)
        trace.time_solve.append(message.time_solve)
        trace.time_step.append(message.time_step)
        for entry in message.rows:
            if entry.slack:
                trace.slack[entry.name] = max(trace.slack.get(entry.name, 0.0), abs(entry.slack))
        if message.fallback_reason:
            trace.fallback_reasons.add(message.fallback_reason)
        trace.constraints.append(time, message)
        trace.loads.append(time, message)
        trace.counts = {count.name: count.count for count in message.counts}
