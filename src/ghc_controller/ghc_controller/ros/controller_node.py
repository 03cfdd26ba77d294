"""The controller behind ROS topics: answers every robot state with a torque.

Publishes  joint_commands (stamp = the state answered, effort [Nm] by joint name),
           ghc/transition_status, ghc/priority_matrix (latched), ghc/controller_state,
           ghc/tick (start and epoch of the generators' next tick), /diagnostics, and with
           mirror_commands /effort_controller/commands (ros2_control).
Subscribes joint_states (effort = torque applied over the last period), sim_bridge/epoch (latched),
           ghc/priority_transition, ghc/task_reference, constraints/preview, contacts/<name>
           where it has to wait for them, odom for a floating base.
Parameters see ControllerParameters.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from typing import Any
from uuid import uuid4

from ghc_msgs.msg import ConstraintPreviews
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from ghc_controller.controller import Controller
from ghc_controller.core import Clock
from ghc_controller.errors import InvalidValue
from ghc_controller.robot.library import load_robot
from ghc_controller.ros.modes import ModeServer
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.ros.previews import PREVIEW_TOPIC, PreviewInbox
from ghc_controller.ros.process.in_turns import in_turns
from ghc_controller.ros.qos import CONTROL_PUBLISHER_QOS, PREVIEW_SUBSCRIBER_QOS
from ghc_controller.ros.rejections import CONTROLLER, Rejections, warning
from ghc_controller.ros.requests import RequestSubscriber
from ghc_controller.ros.run import run_node, tolerant
from ghc_controller.ros.states import StateSubscriber
from ghc_controller.ros.status import StatusPublisher
from ghc_controller.ros.tuning.set_parameters import SETTINGS_THAT_CHANGE, ParameterTuning
from ghc_controller.ros.wire.joint_state import (
    JointStateEncoder,
    JointStateValues,
)
from ghc_controller.ros.wire.joint_state_reader import JointStateReader
from ghc_controller.ros.wire.old_clients import OldClients
from ghc_controller.safety.modes import Mode
from ghc_controller.safety.plausibility import ImplausibleStart, StatePlausibility
from ghc_controller.schema.reader import Fields
from ghc_controller.settings import Settings
from ghc_controller.types import Array, RobotState

NODE_NAME = "controller"
DIAGNOSTICS_PERIOD = 1.0  # [s] wall
IDLE_PERIOD = 0.05  # [s] wall; requests are processed even without states
SWITCH_INTERVAL = 1e-4  # [s] wall
DOUBT = 0.1  # [s] wall; states that are implausible for longer are a fault


def _of_robot(given: Fields) -> ControllerParameters | None:
    """The controller's settings in robot.yaml."""
    robot = given.value("robot", "")
    if not isinstance(robot, str) or not robot:
        return None
    return ControllerParameters(settings=Settings.for_robot(load_robot(robot)))


class ControllerNode:
    """Wires topics to the controller; no arithmetic here."""

    def __init__(self, stop: Future) -> None:  # noqa: ARG002 - no message stops it
        """Read the parameters, load the robot, subscribe.

        Raises:
            GhcError: a parameter, or a file that it names, cannot be used.
        """
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        self._parameters = p = read_parameters(
            self.node, ControllerParameters, _of_robot, SETTINGS_THAT_CHANGE
        )
        self.executor = p.executor
        clock = None if p.lockstep else Clock()
        self._controller = Controller.for_robot(p.robot, p.settings, clock)
        self._tuning = ParameterTuning(self.node, self._controller)
        self._reader = JointStateReader(self._controller.model.joint_names)
        self._rejections = Rejections()
        self._states = StateSubscriber(
            self.node, p, self._controller.model.floating_base, self, self._reject
        )
        self._previews = PreviewInbox(self._controller, self._states.plan, self._reject)
        self._modes = ModeServer(self.node, self._controller, p.armed_by, self._states.forget)
        model = self._controller.model
        self._plausibility = StatePlausibility(model.joint_names, model.limits, model.weight)
        self._doubted_since: float | None = None  # [s] wall, time of the first implausible state
        self._requests = RequestSubscriber(
            self.node,
            self._controller,
            self._modes.logic,
            p.lockstep,
            self._states,
            self._reject,
        )
        self._status = StatusPublisher(self.node, self._controller, self._rejections, p.state_rate)
        self._resets = False  # whether a run has begun for which the controller was not reset yet
        self._now: float | None = None  # [s] of the last state
        self._answered_at = 0.0  # [s] wall
        sender = f"{self.node.get_name()}_{uuid4().hex[:8]}"  # tells commanders apart
        self._encoder = JointStateEncoder(self._controller.model.joint_names, sender, motion=False)
        self._command = b""  # serialized, of the last answered state
        self._old_clients = OldClients(self.node)
        self._publish_and_listen()
        p.scheduling.apply()
        self.node.get_logger().info(
            f"{p.robot}: {len(self._controller.stack.tasks)} tasks, formulation "
            f"{self._controller.formulation.name}, solver {p.settings.qp_solver}: ready"
        )
        unheard = sorted(set(self._controller.robot.felt_contacts) - set(p.wait_for_contacts))
        if unheard:
            self.node.get_logger().warning(
                f"the wrench of {', '.join(unheard)} is used by robot.yaml and not listened to: "
                "name it in the parameter wait_for_contacts; until then plans alone say what "
                "touches, and forces are not controlled"
            )

    def _publish_and_listen(self) -> None:
        node, p = self.node, self._parameters
        self._commands = node.create_publisher(JointState, "joint_commands", CONTROL_PUBLISHER_QOS)
        self._mirror = (
            node.create_publisher(Float64MultiArray, "/effort_controller/commands", 1)
            if p.mirror_commands
            else None
        )
        take: Callable[[Any], None] = tolerant(self._previews.take, PREVIEW_TOPIC, self._reject)
        node.create_subscription(ConstraintPreviews, PREVIEW_TOPIC, take, PREVIEW_SUBSCRIBER_QOS)
        look = self._look_for_old_clients
        in_turns(node, DIAGNOSTICS_PERIOD, self._publish_diagnostics, look, look)
        if not p.lockstep:
            wall = RosClock(clock_type=ClockType.STEADY_TIME)
            node.create_timer(IDLE_PERIOD, self._on_idle, clock=wall)
            # The request thread yields to the control thread within this time.
            sys.setswitchinterval(SWITCH_INTERVAL)

    def repeat(self) -> None:
        """Resend the command: its state was repeated."""
        self._commands.publish(self._command)

    def resume(self) -> None:
        """States were lost: accept any state inside the limits next."""
        self._plausibility.resume()

    def answer(self, values: JointStateValues, new_epoch: bool) -> None:
        """Answer a complete state of the current run; `new_epoch`: the first one of a run."""
        controller, stamp_ns = self._controller, values.stamp_ns
        self._resets |= new_epoch
        try:
            companions = self._states.companions(stamp_ns)
            state = self._reader.read(values, self._states.epoch, *companions)
        except InvalidValue as error:
            self._states.forget()
            self._reject(str(error).split(":")[0], str(error))
            return
        if new_epoch:
            self._plausibility.reset()
        if not self._is_plausible(state):
            return
        part = "the beginning of a run" if self._resets or not self._requests.is_open else "a step"
        try:
            self._get_ready(state, stamp_ns)
            result = None if self._modes.mode is Mode.LATCHED else controller.step(state)
        except Exception as error:
            if not self._modes.logic.latches:
                raise
            self._modes.logic.fault(f"{part} raised {type(error).__name__}: {error}")
            self._send(values, controller.brake(state))  # this state is answered as well
            return
        if result is None:
            self._send(values, controller.brake(state))
            self._requests.tell(controller.take_events())  # what the fault has ended
            return
        self._send(values, result.torque)
        self._requests.tell(result.events)
        self._status.publish(stamp_ns, self._states.epoch, result.status)
        self._modes.stepped(state.time, result.status)

    def _get_ready(self, state: RobotState, stamp_ns: int) -> None:
        """Take in what belongs to a state: a new run, previews, requests.

        A reset that raises, of a task or constraint of another package, is due until it has ended.
        """
        controller, resets = self._controller, self._resets
        begins = resets or not self._requests.is_open
        if resets:
            controller.reset()
            self._previews.forget()
            self._status.reset()
            self._resets = False
        if begins:
            self._modes.begin(state.time)
        self._previews.hand_over(self._states.epoch, stamp_ns)
        if begins:
            controller.observe(state)
        self._now = state.time
        self._answered_at = time.monotonic()
        try:
            self._requests.at(state.time)
        finally:  # a request that raises does not keep the run from beginning
            if resets:
                self._requests.begin_run()

    def _send(self, values: JointStateValues, torque: Array) -> None:
        """Answer a state with a torque (a,) [Nm]."""
        stamp_ns = values.stamp_ns
        self._command = self._encoder.encode(stamp_ns, torque)
        self._commands.publish(self._command)
        self._states.answered(stamp_ns)
        if self._mirror is not None:
            self._mirror.publish(Float64MultiArray(data=torque))

    def _is_plausible(self, state: RobotState) -> bool:
        """Whether a state is plausible; implausible states for too long are a fault.

        In lockstep states come from the simulator and only need to be finite.
        """
        if self._parameters.lockstep:
            return True
        now = time.monotonic()
        try:
            self._plausibility.check(state)
        except InvalidValue as error:
            self._states.forget()
            told = self._reject(str(error).split(":")[0], str(error))
            if isinstance(error, ImplausibleStart):
                if told:  # a measured position differs in every state
                    self._modes.logic.waits(f"cannot start: {error}")
            elif self._doubted_since is None:
                self._doubted_since = now
            elif now - self._doubted_since > DOUBT and self._requests.is_open:
                self._modes.logic.fault(f"no plausible state for {DOUBT:g} s: {error}")
            return False
        self._doubted_since = None
        if self._plausibility.jumped:
            self._reject(
                f"{self._plausibility.jumped.split(':')[0]}.jump", self._plausibility.jumped
            )
            self._modes.logic.fault(self._plausibility.jumped)
        return True

    def _reject(self, field: str, reason: str) -> bool:
        """Count a rejection; returns whether it was logged (rate-limited per field)."""
        told = self._rejections.count(field, time.monotonic())
        if told:
            self.node.get_logger().warning(warning(field, reason, CONTROLLER))
        return told

    def _on_idle(self) -> None:
        if time.monotonic() - self._answered_at <= IDLE_PERIOD:
            return
        try:
            self._requests.between_states()
        except Exception as error:  # of another package; raised here, it would end the node
            words = f"a request raised {type(error).__name__}: {error}"
            self._reject("requests", words)
            self._modes.logic.fault(words)

    def _look_for_old_clients(self) -> None:
        mismatch = self._old_clients.look()
        if mismatch:
            self.node.get_logger().warning(mismatch)

    def _publish_diagnostics(self) -> None:
        modes = self._modes
        lasting = [self._previews.silent(self._now or 0.0)]
        if modes.mode is Mode.LATCHED:
            lasting.insert(0, modes.text)
        self._status.publish_diagnostics(self._now, "; ".join(filter(None, lasting)), modes.text)

    def close(self) -> None:
        """End the thread that parses requests."""
        self._requests.close()


def main(args: Sequence[str] | None = None) -> int:
    """Run the controller until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, ControllerNode, args)


if __name__ == "__main__":
    sys.exit(main())
