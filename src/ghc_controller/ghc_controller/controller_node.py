"""The controller behind ROS topics: answers every robot state with a torque.

Publishes  joint_commands (stamp = the state answered, effort [Nm] by joint name),
           ghc/transition_status, ghc/priority_matrix (latched), ghc/controller_state,
           ghc/tick (start and epoch of the generators' next tick), /diagnostics, and with
           mirror_commands /effort_controller/commands (ros2_control).
Subscribes joint_states (frame_id = epoch, effort = torque applied over the last period),
           ghc/priority_transition, ghc/task_reference, constraints/contact_force_bounds,
           constraints/obstacle_motion, contacts/<name> where it has to wait for them, odom for a
           floating base.
Parameters see ControllerParameters.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import (
    ControllerState,
    PriorityMatrix,
    PriorityTransition,
    TaskReference,
    TransitionStatus,
)
from nav_msgs.msg import Odometry
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, Header

from ghc_controller.cdr import encode_header, read_stamp
from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.joint_state_cdr import (
    JointStateDecoder,
    JointStateEncoder,
    JointStateValues,
)
from ghc_controller.joint_state_reader import JointStateReader
from ghc_controller.node_parameters import read_parameters
from ghc_controller.parameters import ControllerParameters
from ghc_controller.plan_conversions import PLAN_QOS, obstacle_message
from ghc_controller.plan_inbox_node import PLANS, PlanInbox
from ghc_controller.rejections import Rejections
from ghc_controller.report import StepStatus
from ghc_controller.ros_conversions import (
    CONTROL_PUBLISHER_QOS,
    CONTROL_SUBSCRIBER_QOS,
    LATCHED_QOS,
    NANOSECONDS,
    RELIABLE_QOS,
    STREAM_QOS,
    base_from_bytes,
    controller_state_message,
    diagnostics_message,
    event_message,
    matrix_message,
    read_joint_state,
    reference_from_message,
    status_message,
    transition_from_message,
    wrench_from_bytes,
)
from ghc_controller.run_node import guarded, run_node
from ghc_controller.state_gate import StateGate, Verdict
from ghc_controller.tick_announcer import TickAnnouncer

NODE_NAME = "controller"
ODOMETRY = "odom"
DIAGNOSTICS_PERIOD = 1.0  # [s] wall


class ControllerNode:
    """Wires topics to the controller; no arithmetic here."""

    def __init__(self, stop: Future) -> None:
        """Read the parameters, load the robot, compile, listen.

        Raises:
            GhcError: a parameter, or a file that it names, cannot be used.
        """
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        self._parameters = p = read_parameters(self.node, ControllerParameters)
        self.executor = p.executor
        self._controller = Controller.for_robot(p.robot, p.settings())
        self._controller.warm_up()
        self._reader = JointStateReader(self._controller.model.joint_names)
        base = (ODOMETRY,) if self._controller.model.floating_base else ()
        self._gate: StateGate[JointStateValues] = StateGate(
            base + p.wait_for_contacts, p.wait_for_bounds, round(p.bounds_step * NANOSECONDS)
        )
        self._announcer = TickAnnouncer(
            round(p.control_dt * NANOSECONDS), round(p.bounds_step * NANOSECONDS)
        )
        self._plans = PlanInbox(self._controller, self._on_plan, self._reject)
        self._rejections = Rejections()
        self._early: list[Callable[[], None]] = []  # requests that came before the first state
        self._now: float | None = None  # [s] of the last state
        self._decoder = JointStateDecoder(read_joint_state)
        self._encoder = self._make_encoder("")
        self._command = b""  # serialized, of the last answered state
        self._state_period_ns = round(NANOSECONDS / p.state_rate)
        self._state_due_ns = 0
        self._shown_matrix: tuple[bytes, bool, int] | None = None
        self._publish_and_listen(stop)
        self.node.get_logger().info(
            f"{p.robot}: {len(self._controller.stack.tasks)} tasks, formulation "
            f"{self._controller.formulation.name}, solver {p.qp_solver}: ready"
        )

    def _publish_and_listen(self, stop: Future) -> None:
        node, p = self.node, self._parameters
        self._commands = node.create_publisher(JointState, "joint_commands", CONTROL_PUBLISHER_QOS)
        self._status = node.create_publisher(
            TransitionStatus, "ghc/transition_status", RELIABLE_QOS
        )
        self._matrix = node.create_publisher(PriorityMatrix, "ghc/priority_matrix", LATCHED_QOS)
        self._state = node.create_publisher(ControllerState, "ghc/controller_state", STREAM_QOS)
        self._ticks = node.create_publisher(Header, "ghc/tick", CONTROL_PUBLISHER_QOS)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._mirror = (
            node.create_publisher(Float64MultiArray, "/effort_controller/commands", 1)
            if p.mirror_commands
            else None
        )
        node.create_subscription(
            JointState,
            "joint_states",
            guarded(stop, self._on_state),
            CONTROL_SUBSCRIBER_QOS,
            raw=True,
        )
        for name in p.wait_for_contacts:
            node.create_subscription(
                WrenchStamped,
                f"contacts/{name}",
                guarded(stop, partial(self._on_wrench, name)),
                CONTROL_SUBSCRIBER_QOS,
                raw=True,
            )
        if self._controller.model.floating_base:
            node.create_subscription(
                Odometry,
                ODOMETRY,
                guarded(stop, self._on_odometry),
                CONTROL_SUBSCRIBER_QOS,
                raw=True,
            )
        for name, kind in PLANS.items():
            take = guarded(stop, partial(self._plans.take, name))
            node.create_subscription(kind, f"constraints/{name}", take, PLAN_QOS)
        for message, topic, handle in (
            (PriorityTransition, "ghc/priority_transition", self._on_transition),
            (TaskReference, "ghc/task_reference", self._on_reference),
        ):
            node.create_subscription(
                message,
                topic,
                guarded(stop, partial(self._after_first_state, handle)),
                RELIABLE_QOS,
            )
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(DIAGNOSTICS_PERIOD, self._publish_diagnostics, clock=wall)

    def _make_encoder(self, frame_id: str) -> JointStateEncoder:
        return JointStateEncoder(self._controller.model.joint_names, frame_id, motion=False)

    def _on_state(self, data: bytes) -> None:
        try:
            state = self._decoder.decode(data)
        except ValueError as error:
            self._reject("joint_states", str(error))
            return
        overdue_ns = self._gate.waiting_ns
        if overdue_ns is not None and state.stamp_ns > overdue_ns:
            for name in self._gate.missing(overdue_ns):
                self._reject(
                    f"{name}.stamp",
                    f"none of stamp {overdue_ns / NANOSECONDS:.6f} s came, as joint_states has it",
                )
        verdict = self._gate.state(state, state.stamp_ns, state.frame_id)
        if verdict not in (Verdict.STALE, Verdict.MALFORMED):
            self._announce(self._announcer.on_state(state.stamp_ns, self._gate.epoch))
        self._handle(state, verdict)

    def _announce(self, tick_ns: int | None) -> None:
        if tick_ns is not None:
            self._ticks.publish(encode_header(tick_ns, str(self._gate.epoch)))

    def _on_odometry(self, data: bytes) -> None:
        try:
            base = base_from_bytes(data)
        except InvalidValue as error:
            self._reject(ODOMETRY, str(error))
            return
        self._continue(self._gate.companion(ODOMETRY, read_stamp(data), base))

    def _on_plan(self, name: str, stamp_ns: int, epoch: int) -> None:
        self._continue(self._gate.plan(name, stamp_ns, epoch))

    def _continue(self, complete: tuple[JointStateValues, Verdict] | None) -> None:
        if complete is not None:
            self._handle(*complete)

    def _on_wrench(self, name: str, data: bytes) -> None:
        try:
            wrench = wrench_from_bytes(data)
        except InvalidValue as error:
            self._reject(f"contacts/{name}", str(error))
            return
        self._continue(self._gate.companion(name, read_stamp(data), wrench))

    def _handle(self, values: JointStateValues, verdict: Verdict) -> None:
        if verdict is Verdict.REPEATED:
            self._commands.publish(self._command)
        elif verdict is Verdict.STALE:
            self._reject("joint_states.stamp", "older than the last one, in the same epoch")
        elif verdict is Verdict.MALFORMED:
            self._reject(
                "joint_states.frame_id",
                f"'{values.frame_id}' given, an epoch such as '0' (or nothing) expected",
            )
        elif verdict in (Verdict.NEW, Verdict.NEW_EPOCH):
            self._answer(values, verdict is Verdict.NEW_EPOCH)

    def _answer(self, values: JointStateValues, new_epoch: bool) -> None:
        controller, stamp_ns = self._controller, values.stamp_ns
        wrenches = self._gate.values
        base = wrenches.pop(ODOMETRY, None)
        try:
            state = self._reader.read(values, self._gate.epoch, wrenches, base)
        except InvalidValue as error:
            self._gate.forget()
            self._reject(str(error).split(":")[0], str(error))
            return
        if new_epoch:
            controller.reset()
            self._plans.forget()
            self._state_due_ns = 0
        self._plans.hand_over(self._gate.epoch, stamp_ns)
        first = self._now is None
        self._now = state.time
        if first:
            controller.observe(state)
            for request in self._early:
                request()
            self._early.clear()
        result = controller.step(state)
        if values.frame_id != self._encoder.frame_id:
            self._encoder = self._make_encoder(values.frame_id)
        self._command = self._encoder.encode(stamp_ns, result.torque)
        self._commands.publish(self._command)
        self._gate.answered(stamp_ns)
        self._announce(self._announcer.on_answer(stamp_ns, self._gate.epoch))
        if self._mirror is not None:
            self._mirror.publish(Float64MultiArray(data=result.torque))
        for event in result.events:
            self._status.publish(event_message(event))
        if stamp_ns >= self._state_due_ns or result.status is StepStatus.FALLBACK:
            period = self._state_period_ns
            self._state_due_ns = stamp_ns - stamp_ns % period + period
            self._publish_state()

    def _publish_state(self) -> None:
        controller = self._controller
        report = controller.report()
        report.counts.update({f"rejected_{k}": n for k, n in self._rejections.counts.items()})
        message = controller_state_message(
            report,
            controller.formulation.name,
            controller.formulation.solver.name,
            controller.model.joint_names,
        )
        message.obstacles = [obstacle_message(entry) for entry in report.obstacles]
        self._state.publish(message)
        priorities = controller.priorities
        shown = (priorities.alpha.tobytes(), priorities.in_transition, self._gate.epoch)
        if shown != self._shown_matrix:  # latched: who comes later gets the last one
            self._shown_matrix = shown
            self._matrix.publish(matrix_message(priorities, report.result.time))

    def _after_first_state(
        self,
        handle: Callable[[PriorityTransition | TaskReference], None],
        message: PriorityTransition | TaskReference,
    ) -> None:
        """Requests are judged at a robot state: those that come before it wait."""
        if self._now is None:
            self._early.append(partial(handle, message))
        else:
            handle(message)

    def _on_transition(self, message: PriorityTransition) -> None:
        now = self._now or 0.0
        controller = self._controller
        try:
            transition = transition_from_message(message, controller.robot.task_names, now)
            self._check_start(transition.start, now)
            is_new = controller.add_transition(transition, now)
        except GhcError as error:
            self._status.publish(
                status_message(TransitionStatus.REJECTED, now, None, message.id, str(error))
            )
            self._reject("ghc/priority_transition", str(error))
            return
        if is_new:
            self._gate.forget()  # the state in force is worked out again with it
            for event in controller.take_events():
                self._status.publish(event_message(event))
            return
        # A repeat: its DONE follows at once only where the ramp is over.
        self._status.publish(status_message(TransitionStatus.ACCEPTED, now, transition))
        if controller.priorities.is_settled:
            self._status.publish(status_message(TransitionStatus.DONE, now, transition))

    def _on_reference(self, message: TaskReference) -> None:
        now = self._now or 0.0
        controller = self._controller
        try:
            schedule = controller.schedule_of(message.task)
            task = schedule.task(message.task)
            current = schedule.current(message.task, now).position
            reference = reference_from_message(message, task, current, now)
            self._check_start(reference.start_time, now)
            controller.add_reference(reference)
        except GhcError as error:
            self._reject("ghc/task_reference", str(error))
            return
        self._gate.forget()

    def _check_start(self, start: float, now: float) -> None:
        if self._parameters.lockstep and start < now:
            raise InvalidValue(
                f"start {start:g} s given, {now:g} s (now) or later expected: in lockstep a late "
                "request would make the run depend on when it arrived"
            )

    def _reject(self, field: str, reason: str) -> None:
        if self._rejections.count(field, time.monotonic()):
            self.node.get_logger().warning(f"{field}: {reason}")

    def _publish_diagnostics(self) -> None:
        controller = self._controller
        counts = controller.counts | controller.gate.counts
        rejected = {f"rejected_{k}": n for k, n in sorted(self._rejections.counts.items())}
        trouble = counts["fallback_ticks"] + sum(self._rejections.counts.values())
        stamp_ns = round((self._now or 0.0) * NANOSECONDS)
        summary = "ok" if self._now is not None else "waiting for joint_states"
        silence = self._plans.silent(self._now or 0.0)
        if trouble:
            summary = f"{counts['fallback_ticks']} ticks without a solution, "
            summary += f"{sum(self._rejections.counts.values())} inputs refused"
        summary = "; ".join(part for part in (silence, summary) if part)
        values: dict[str, object] = {"formulation": controller.formulation.name}
        warning = trouble > 0 or bool(silence)
        self._diagnostics.publish(
            diagnostics_message(stamp_ns, NODE_NAME, summary, warning, values | counts | rejected)
        )

    def close(self) -> None:
        """Nothing to be written."""


def main(args: Sequence[str] | None = None) -> int:
    """Run the controller until a signal; exit code 0, 1 (failed while running) or 2 (refused)."""
    return run_node(NODE_NAME, ControllerNode, args)


if __name__ == "__main__":
    sys.exit(main())
