"""What RViz and Foxglove need to draw the robot, simulated or real: model, transforms, markers.

Publishes   robot_description (latched), /tf, /tf_static (latched), ghc/markers.
Subscribes  joint_states, odom (floating base), ghc/controller_state, contacts/<name>,
            constraints/obstacles; all best effort, the newest message of each.
Parameters see DisplayParameters.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import ControllerState, ObstacleStateArray
from nav_msgs.msg import Odometry
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from ghc_controller.errors import ConfigurationError, GhcError, InvalidValue
from ghc_controller.robot.library import load_robot
from ghc_controller.ros.conversions.states import base_from_bytes, wrench_from_bytes
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS, LATCHED_QOS, PREVIEW_QOS
from ghc_controller.ros.rejections import Rejections
from ghc_controller.ros.run import guarded, run_node
from ghc_controller.ros.time import time_from_nanoseconds
from ghc_controller.ros.wire.cdr import read_stamp
from ghc_controller.types import Array
from ghc_sim_bridge.display.description import description_of
from ghc_sim_bridge.display.link_tree import LinkTree, Transform
from ghc_sim_bridge.ros.display.parameters import DisplayParameters
from ghc_sim_bridge.ros.display.scenery import Scenery
from ghc_sim_bridge.ros.display.transforms import STATIC_TF_QOS, TF_QOS, TransformNames
from ghc_sim_bridge.scene.description import load_scene

NODE_NAME = "display_publisher"
STALE_NS = (
    500_000_000  # [ns] of the robot's time: forces and obstacles that are older are not shown
)
_SAME_PLACE = (np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))


class DisplayPublisher:
    """Keeps the newest messages as bytes and publishes what they show at the pace of a screen."""

    def __init__(self, stop: Future) -> None:
        """Load the robot, publish what never changes, listen.

        Raises:
            GhcError: a parameter or a file cannot be used.
        """
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        p = read_parameters(self.node, DisplayParameters)
        self.executor = p.executor
        scene = load_scene(p.scene) if p.scene else None
        if not p.robot and scene is None:
            raise ConfigurationError("parameter 'robot': it is needed, or a 'scene'")
        robot = load_robot(p.robot if p.robot or scene is None else scene.robot_file)
        urdf = Path(p.description).expanduser() if p.description else robot.urdf
        text = description_of(urdf)
        self._tree = LinkTree(text, str(urdf))
        self._floats = robot.floating_base
        self._joints = robot.model.joint_names
        self._scenery = Scenery(robot, scene, p.world_frame, p.force_scale)
        self._names = TransformNames(self._prefix(p.frame_prefix), p.world_frame)
        self._rejections = Rejections()
        self._newest: dict[str, bytes] = {}
        self._shown_ns: tuple[int, int] = (-1, -1)  # stamps of the last state and odometry
        self._publish_what_stays(text)
        self._listen(stop, 1.0 / p.rate)
        self.node.get_logger().info(f"{robot.name}: ready")

    def _prefix(self, given: str) -> str:
        space = self.node.get_namespace().strip("/")
        return given or (f"{space}/" if space else "")

    def _publish_what_stays(self, text: str) -> None:
        node = self.node
        self._tf = node.create_publisher(TFMessage, "/tf", TF_QOS)
        self._markers = node.create_publisher(MarkerArray, "ghc/markers", PREVIEW_QOS)
        self._description = node.create_publisher(String, "robot_description", LATCHED_QOS)
        self._description.publish(String(data=text))
        self._static_tf = node.create_publisher(TFMessage, "/tf_static", STATIC_TF_QOS)
        fixed = [*self._tree.fixed]
        if not self._floats and self._tree.root != self._names.world:
            fixed.append(Transform(self._names.world, self._tree.root, *_SAME_PLACE))
        self._static_tf.publish(self._names.message(fixed, Time()))

    def _listen(self, stop: Future, period: float) -> None:
        topics: dict[str, type] = {
            "joint_states": JointState,
            "ghc/controller_state": ControllerState,
            "constraints/obstacles": ObstacleStateArray,
            **{f"contacts/{name}": WrenchStamped for name in self._scenery.sites},
        }
        if self._floats:
            topics["odom"] = Odometry
        for topic, kind in topics.items():
            # As bytes: of a thousand messages a second only those that are shown are read.
            self.node.create_subscription(
                kind, topic, partial(self._keep, topic), CONTROL_SUBSCRIBER_QOS, raw=True
            )
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        self.node.create_timer(period, guarded(stop, self._show), clock=wall)

    def _keep(self, topic: str, data: bytes) -> None:
        self._newest[topic] = data

    def _show(self) -> None:
        state, odometry = self._newest.get("joint_states"), self._newest.get("odom")
        if state is None or (self._floats and odometry is None):
            return
        try:
            stamps = (read_stamp(state), -1 if odometry is None else read_stamp(odometry))
            if stamps == self._shown_ns:
                return
            positions = _positions(state)
            base = None if odometry is None else base_from_bytes(odometry)[:7]
        except (GhcError, ValueError, RuntimeError, IndexError) as error:
            self._reject("joint_states or odom", str(error))
            return
        self._shown_ns = stamps
        moving = self._names.message(
            self._tree.moving(positions), time_from_nanoseconds(stamps[0])
        ).transforms
        if base is not None:
            root = Transform(self._names.world, self._tree.root, base[:3], base[3:])
            moving += self._names.message([root], time_from_nanoseconds(stamps[1])).transforms
        self._tf.publish(TFMessage(transforms=moving))
        self._show_markers(stamps[0], positions, base)

    def _show_markers(
        self, stamp_ns: int, positions: dict[str, float], base: Array | None
    ) -> None:
        missing = [name for name in self._joints if name not in positions]
        if missing:
            self._reject("joint_states.name", f"{', '.join(missing)} missing: no markers")
            return
        q = np.array([positions[name] for name in self._joints])
        if base is not None:
            q = np.concatenate([base, q])
        report, obstacles = None, []
        forces: dict[str, Array] = {}
        for topic, data in self._newest.items():
            try:
                fresh = abs(stamp_ns - read_stamp(data)) <= STALE_NS
                if topic == "ghc/controller_state":
                    report = deserialize_message(data, ControllerState)
                elif topic == "constraints/obstacles" and fresh:
                    obstacles = deserialize_message(data, ObstacleStateArray).obstacles
                elif topic.startswith("contacts/") and fresh:
                    forces[topic.removeprefix("contacts/")] = wrench_from_bytes(data)[:3]
            except (GhcError, ValueError, RuntimeError) as error:
                self._reject(topic, str(error))
        stamp = time_from_nanoseconds(stamp_ns)
        self._markers.publish(self._scenery.message(stamp, q, report, forces, obstacles))

    def _reject(self, field: str, reason: str) -> None:
        if self._rejections.count(field, time.monotonic()):
            self.node.get_logger().warning(f"{field}: {reason}")

    def close(self) -> None:
        """No resources to release."""


def _positions(data: bytes) -> dict[str, float]:
    """Joint name -> position [rad] or [m] of a serialized JointState.

    Raises:
        InvalidValue: another number of positions than names, or one that is not finite.
    """
    message = deserialize_message(data, JointState)
    values = np.array(message.position)
    if len(values) != len(message.name):
        raise InvalidValue(
            f"joint_states.position: {len(values)} entries given, {len(message.name)} expected"
        )
    if not np.isfinite(values).all():
        bad = message.name[int(np.argmin(np.isfinite(values)))]
        raise InvalidValue(f"joint_states.position: not a finite number at joint '{bad}'")
    return dict(zip(message.name, values.tolist(), strict=True))


def main(args: Sequence[str] | None = None) -> int:
    """Publish until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, DisplayPublisher, args)


if __name__ == "__main__":
    sys.exit(main())
