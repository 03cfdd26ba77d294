"""The simulated robot behind ROS topics: master of time, in lockstep or by the wall clock.

Publishes  ~/epoch (latched, before the first state of a run: which stamps belong to it),
           joint_states (stamp = simulated time, effort = torque over the last period [Nm]),
           contacts/<name> (force of the environment on the robot, world axes, same stamp, sent
           before), odom where the base floats (pose in the world, twist in base axes; same stamp,
           sent before), constraints/obstacles (readings of the scene's obstacle sensor, at its own
           rate, sent before the state of its stamp), /clock, /diagnostics.
Subscribes joint_commands (stamp = the state that it answers, effort [Nm] by joint name).
Services   ~/reset (std_srvs/Trigger: start state, next epoch), ~/pause (std_srvs/SetBool).
Parameters see BridgeParameters.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import Epoch, ObstacleStateArray
from nav_msgs.msg import Odometry
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

from ghc_controller.ros.conversions.common import diagnostics_message
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.process.in_turns import in_turns
from ghc_controller.ros.qos import (
    CLOCK_QOS,
    CONTROL_PUBLISHER_QOS,
    LATCHED_QOS,
    LOSSLESS_PUBLISHER_QOS,
)
from ghc_controller.ros.run import guarded, run_node
from ghc_controller.ros.time import time_from_nanoseconds
from ghc_controller.safety.torque_gate import TorqueGate
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.diagnostics import BridgeDiagnostics
from ghc_sim_bridge.bridge.lockstep import LockstepMode
from ghc_sim_bridge.bridge.patient_publishing import patient
from ghc_sim_bridge.bridge.publisher import WORLD_FRAME, Observe, Publish, StatePublisher
from ghc_sim_bridge.bridge.realtime import RealtimeMode, Watchdog
from ghc_sim_bridge.bridge.run_mode import RunMode
from ghc_sim_bridge.logs.full_rate_log import FullRateLogBuffer
from ghc_sim_bridge.parameters import BridgeParameters
from ghc_sim_bridge.ros.commands import CommandSubscriber
from ghc_sim_bridge.ros.conversions import obstacles_message
from ghc_sim_bridge.ros.others import CLOCK, YoungBridge, refuse_second_bridge
from ghc_sim_bridge.ros.shared_clock import SharedClock
from ghc_sim_bridge.simulation.disturbances import Disturbances, Magnitudes
from ghc_sim_bridge.simulation.obstacle_sensor import ObstacleSensor
from ghc_sim_bridge.simulation.simulator import Simulator

NODE_NAME = "sim_bridge"
DIAGNOSTICS_PERIOD = 1.0  # [s] wall
DELIVERY_TIMEOUT = Duration(seconds=3)  # wall, per topic, when stopped with `lossless` on
NEVER_NS = 1 << 62  # [ns] later than any simulated time


def disturbances_of(p: BridgeParameters) -> Disturbances | None:
    """The disturbances set by the parameters."""
    if p.disturbance_seed < 0:
        return None
    magnitudes = Magnitudes(
        mass=p.disturbance_mass,
        friction_lower=p.disturbance_friction_lower,
        friction_upper=p.disturbance_friction_upper,
        push=p.disturbance_push if p.disturbance_push_frame else 0.0,
        push_frame=p.disturbance_push_frame,
        push_duration=p.disturbance_push_duration,
        push_from=p.disturbance_push_from,
        push_until=p.disturbance_push_until,
        velocity_noise=p.disturbance_velocity_noise,
    )
    return Disturbances(magnitudes, p.disturbance_seed)


class SimBridge:
    """Wires topics and services to the control cycle; no arithmetic here."""

    def __init__(self, stop: Future) -> None:
        """Read the parameters, load the scene, publish the first state.

        `stop` ends the node, also with an error that occurs while running.

        Raises:
            GhcError: a parameter, or a file that it names, cannot be used.
        """
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        self._parameters = p = read_parameters(self.node, BridgeParameters)
        self.executor = p.executor
        since = time.monotonic()
        clock = self._advertise(Clock, CLOCK, CLOCK_QOS, stop)  # others discover it meanwhile
        simulator = Simulator(
            p.scene,
            control_dt=p.control_dt,
            physics_dt=p.physics_dt,
            disturbances=disturbances_of(p),
        )
        wrenches = tuple(simulator.contact_wrenches())
        gate = TorqueGate(simulator.torque_limit, p.torque_rate_limit, p.control_dt)
        self._log = (
            FullRateLogBuffer(
                simulator.joint_names, wrenches, p.control_dt, simulator.floating_base
            )
            if p.log_file
            else None
        )
        self._rows_saved = -1  # a run that is stopped immediately still writes an empty log
        self._cycle = ControlCycle(simulator, gate, self._log)
        self._stop_ns = round(p.stop_time * NANOSECONDS) if p.stop_time > 0.0 else NEVER_NS
        self._commands = CommandSubscriber(self.node, self._cycle)
        self._health = BridgeDiagnostics(self._commands.rejections)
        refuse_second_bridge(self.node, since)
        self._clock = SharedClock(self.node, clock, lambda: self._cycle.time_ns)
        self._epochs = self.node.create_publisher(Epoch, "~/epoch", LATCHED_QOS)
        self._publisher = self._make_publisher(wrenches if p.publish_contacts else (), stop)
        self._mode = self._make_mode()
        self._mode.paused = p.paused
        self._young = YoungBridge(self.node, lambda: self._cycle.time_ns, stop)
        self._listen(stop)
        p.scheduling.apply()
        self._begin_run()
        self.node.get_logger().info(
            f"scene '{p.scene}', {p.mode}, {'paused' if p.paused else 'running'}"
        )

    def _advertise(self, kind: type, topic: str, qos: QoSProfile, stop: Future) -> Publish:
        """Publisher of a topic; with `lossless` it waits for slow readers."""
        p = self._parameters
        if not p.lossless:
            return self.node.create_publisher(kind, topic, qos).publish
        publish: Publish = self.node.create_publisher(kind, topic, LOSSLESS_PUBLISHER_QOS).publish
        return patient(publish, topic, p.lockstep_timeout, stop.done)

    def _make_publisher(self, contacts: Sequence[str], stop: Future) -> StatePublisher:
        def advertise(kind: type, topic: str) -> Publish:
            return self._advertise(kind, topic, CONTROL_PUBLISHER_QOS, stop)

        return StatePublisher(
            advertise(JointState, "joint_states"),
            self._clock,
            {name: advertise(WrenchStamped, f"contacts/{name}") for name in contacts},
            self._make_observer(advertise),
            advertise(Odometry, "odom") if self._cycle.simulator.floating_base else None,
        )

    def _make_observer(self, advertise: Callable[[type, str], Publish]) -> Observe | None:
        """Publisher of the scene's obstacle sensor; None without one."""
        simulator = self._cycle.simulator
        scene = simulator.scene
        if scene.sensor_period is None:
            return None
        for obstacle in scene.obstacles:
            simulator.frame_position(obstacle.protected_frame)  # an unknown one ends the node now
        sensor = ObstacleSensor(scene.obstacles, scene.sensor_period, simulator.control_dt)
        publish = advertise(ObstacleStateArray, "constraints/obstacles")

        def observe(cycle: ControlCycle) -> None:
            if sensor.is_due(cycle.run_ns):
                readings = sensor.read(cycle.run_ns, simulator.frame_position)
                publish(obstacles_message(cycle.time_ns, WORLD_FRAME, readings))

        return observe

    def _make_mode(self) -> RunMode:
        p, publish = self._parameters, partial(self._publisher.publish, self._cycle)
        if p.mode == "realtime":
            watchdog = Watchdog(round(p.watchdog_timeout * NANOSECONDS))
            applied = self._commands.applied
            return RealtimeMode(self._cycle, publish, applied, watchdog, self._stop_ns)
        return LockstepMode(
            self._cycle,
            publish,
            self._commands.applied,
            p.lockstep_timeout,
            self._stop_ns,
            lambda: self._commands.refusal,
        )

    def _listen(self, stop: Future) -> None:
        node = self.node
        self._commands.listen(self._mode, self._save_log_at_end, stop)
        node.create_service(Trigger, "~/reset", self._on_reset)
        node.create_service(SetBool, "~/pause", self._on_pause)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(self._mode.tick_period, guarded(stop, self._on_tick), clock=wall)
        in_turns(node, DIAGNOSTICS_PERIOD, self._publish_diagnostics, self._look_for_others)

    def _on_tick(self) -> None:
        self._mode.tick()
        self._save_log_at_end()

    def _on_reset(self, _: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        self._cycle.reset()
        self._begin_run()
        answer.success = True
        answer.message = (
            f"epoch {self._cycle.epoch} from t = {self._cycle.start_ns * 1e-9:.6f} s on"
        )
        return answer

    def _begin_run(self) -> None:
        """Announce the run, then publish its first state."""
        start = time_from_nanoseconds(self._cycle.start_ns)
        self._epochs.publish(Epoch(start=start, number=self._cycle.epoch))
        self._mode.restart()

    def _on_pause(self, request: SetBool.Request, answer: SetBool.Response) -> SetBool.Response:
        self._mode.paused = request.data
        self._mode.restart()
        answer.success = True
        answer.message = f"{'paused' if request.data else 'running'} at t = " + (
            f"{self._cycle.time_ns * 1e-9:.6f} s"
        )
        return answer

    def _look_for_others(self) -> None:
        self._young.look()
        self._clock.look()

    def _publish_diagnostics(self) -> None:
        health = self._health.report(self._cycle, self._parameters.mode, self._mode)
        self._diagnostics.publish(
            diagnostics_message(
                self._cycle.time_ns,
                NODE_NAME,
                health.summary,
                health.warning,
                health.values,
                hardware_id="simulation",
            )
        )

    def _save_log_at_end(self) -> None:
        if self._cycle.run_ns >= self._stop_ns:
            self._save_log()

    def _save_log(self) -> None:
        if self._log is not None and len(self._log) != self._rows_saved:
            self._log.save(Path(self._parameters.log_file))
            self._rows_saved = len(self._log)

    def close(self) -> None:
        """Write the log of a run that was stopped before its end; deliver pending messages."""
        self._save_log()
        if self._parameters.lossless:
            for publisher in self.node.publishers:
                publisher.wait_for_all_acked(DELIVERY_TIMEOUT)


def main(args: Sequence[str] | None = None) -> int:
    """Run the bridge until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, SimBridge, args)


if __name__ == "__main__":
    sys.exit(main())
