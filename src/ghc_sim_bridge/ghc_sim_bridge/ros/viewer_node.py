"""Shows a run live in the Rerun viewer, in a separate process, at no more than 20 Hz.

Subscribes joint_states and ghc/controller_state. Parameters see ViewerParameters.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from ghc_msgs.msg import ControllerState
from nav_msgs.msg import Odometry
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.task import Future
from sensor_msgs.msg import JointState

from ghc_controller.robot.library import find_robot
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.rejections import Rejections
from ghc_controller.ros.run import guarded, run_node, tolerant
from ghc_controller.ros.wire.cdr import read_stamp
from ghc_sim_bridge.parameters import ViewerParameters
from ghc_sim_bridge.ros.conversions import pose_of
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.viewer.layout import new_recording
from ghc_sim_bridge.viewer.live_view import LiveView
from ghc_sim_bridge.viewer.process import ViewerProcess, has_screen, start_viewer
from ghc_sim_bridge.viewer.recording import position_tasks

NODE_NAME = "viewer"
FRAME_PERIOD = 0.05  # [s] wall: what a browser without a graphics card keeps up with
REPORT = "ghc/controller_state"


class Viewer:
    """Keeps the latest messages as bytes and shows them at the pace of a screen."""

    def __init__(self, stop: Future) -> None:
        """Load the scene, start the viewer, listen.

        Raises:
            GhcError: a parameter or a file cannot be used, or the viewer does not start.
        """
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        p = read_parameters(self.node, ViewerParameters)
        self.executor = p.executor
        scene = load_scene(p.scene)
        targets = position_tasks(find_robot(p.robot) if p.robot else scene.robot_file)
        self._recording = new_recording()
        self._viewer: ViewerProcess | None = None
        if p.output:
            Path(p.output).parent.mkdir(parents=True, exist_ok=True)
            self._recording.save(p.output)
        else:
            self._viewer = self._start_viewer(p.display)
            self._recording.connect_grpc(self._viewer.url)
        self._view = LiveView(self._recording, scene, targets)
        self._rejections = Rejections()
        self._state = b""
        self._report = b""
        self._odometry = b""
        self._floats = scene.base is not None
        self._listen(stop)

    def _start_viewer(self, display: str) -> ViewerProcess:
        window = has_screen() if display == "auto" else display == "window"
        viewer = start_viewer(window)
        self.node.get_logger().info(f"open {viewer.page}" if viewer.page else "window opened")
        return viewer

    def _listen(self, stop: Future) -> None:
        node = self.node
        # As bytes: of a thousand messages a second only the twenty that are shown are read.
        node.create_subscription(
            JointState, "joint_states", self._on_state, CONTROL_SUBSCRIBER_QOS, raw=True
        )
        node.create_subscription(
            ControllerState,
            REPORT,
            self._on_report,
            CONTROL_SUBSCRIBER_QOS,
            raw=True,
        )
        if self._floats:
            node.create_subscription(
                Odometry, "odom", self._on_odometry, CONTROL_SUBSCRIBER_QOS, raw=True
            )
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(FRAME_PERIOD, guarded(stop, self._show), clock=wall)

    def _on_state(self, data: bytes) -> None:
        self._state = data

    def _on_odometry(self, data: bytes) -> None:
        self._odometry = data

    def _on_report(self, data: bytes) -> None:
        self._report = data

    def _show(self) -> None:
        tolerant(self._draw_state, "joint_states", self._reject)()
        tolerant(self._draw_report, REPORT, self._reject)()

    def _draw_state(self) -> None:
        if self._state and (self._odometry or not self._floats):
            data, self._state = self._state, b""
            state = deserialize_message(data, JointState)
            self._view.show_state(
                read_stamp(data) * 1e-9,
                state.name,
                np.array(state.position),
                np.array(state.effort),
                pose_of(self._odometry) if self._floats else None,
            )

    def _draw_report(self) -> None:
        if self._report:
            data, self._report = self._report, b""
            report = deserialize_message(data, ControllerState)
            self._view.show_report(read_stamp(data) * 1e-9, report)

    def _reject(self, field: str, reason: str) -> None:
        if self._rejections.count(field, time.monotonic()):
            self.node.get_logger().warning(f"{field} is not shown: {reason}")

    def close(self) -> None:
        """Send pending data; the window or page stays until the user closes it."""
        self._show()
        self._recording.flush()
        self._recording.disconnect()
        if self._viewer is not None:
            self._viewer.leave()


def main(args: Sequence[str] | None = None) -> int:
    """Show the run until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, Viewer, args)


if __name__ == "__main__":
    sys.exit(main())
