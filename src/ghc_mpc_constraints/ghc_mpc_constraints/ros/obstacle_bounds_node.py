"""Obstacle motion behind ROS topics: measured positions in, plans of virtual motion out.

Publishes  constraints/obstacle_motion (stamp and epoch of the tick; one array
           a tick, even when empty), /diagnostics.
Subscribes ghc/tick (when to plan), constraints/obstacles (all that the sensor sees, at
           its own rate), ghc/controller_state (motion in force, before the first plan).
Parameters see ObstacleParameters.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from functools import partial

from ghc_msgs.msg import ObstacleStateArray
from rclpy.task import Future

from ghc_controller.errors import GhcError
from ghc_controller.ros.qos import PLAN_QOS, SENSOR_SUBSCRIBER_QOS
from ghc_controller.ros.run import run_node
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.ros.wire.timeline import MOST_AHEAD_NS
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement
from ghc_mpc_constraints.obstacle_motion.obstacle_bounds import ObstacleBounds
from ghc_mpc_constraints.ros.conversions import (
    measurement_from_message,
    motion_in_force,
    obstacle_motion_message,
)
from ghc_mpc_constraints.ros.generator_node import GeneratorNode
from ghc_mpc_constraints.ros.parameters import ObstacleParameters

NODE_NAME = "obstacle_bounds"


class ObstacleBoundsNode(GeneratorNode[ObstacleParameters]):
    """Wires topics to the generator; no arithmetic here."""

    def __init__(self, stop: Future) -> None:
        """Read the parameters, compile, listen.

        Raises:
            GhcError: a parameter cannot be used.
        """
        super().__init__(NODE_NAME, ObstacleParameters, stop)
        self._generator = ObstacleBounds(self.parameters.settings)
        self._message = ObstacleStateArray()
        self._sensor_period_ns = round(self.parameters.sensor_period * NANOSECONDS)
        self._sensed_ns = -1  # stamp of the newest array
        # A measurement cannot be of the future; ticks are announced by whoever hears them last.
        self._ahead_ns = MOST_AHEAD_NS + self._sensor_period_ns
        self._plans = self.node.create_publisher(
            ObstacleStateArray, "constraints/obstacle_motion", PLAN_QOS
        )
        self.listen(
            ObstacleStateArray, "constraints/obstacles", self._on_obstacles, SENSOR_SUBSCRIBER_QOS
        )
        self.start()
        horizon = self._generator.horizon
        self.node.get_logger().info(
            f"{horizon.steps} steps of {horizon.step:g} s, smoothing "
            f"{'on' if self.parameters.settings.smoothing else 'off'}: ready"
        )

    def ready(self, start_ns: int) -> bool:
        """Whether the obstacles of the last sensor period at or before the tick have come."""
        period = self._sensor_period_ns
        return period == 0 or self._sensed_ns >= start_ns - start_ns % period

    def plan(self, start_ns: int) -> None:
        """Make the plan of a tick and publish it."""
        plan = self._generator.tick(start_ns / NANOSECONDS)
        self._message = obstacle_motion_message(plan, start_ns, self.clock.epoch)
        self._plans.publish(self._message)

    def publish_again(self) -> None:
        """Publish the last plan once more."""
        self._plans.publish(self._message)

    def reset(self) -> None:
        """Forget everything: time starts again."""
        self._generator.reset()
        self._sensed_ns = -1

    def take_over(self, states: Sequence[bytes], start_ns: int) -> bool:
        """Start from the motion in force; False while the sensor has said nothing."""
        for name, state in motion_in_force(states[-1], start_ns / NANOSECONDS).items():
            self._generator.take_over(name, state)
        return self._sensed_ns >= 0

    def report(self) -> tuple[Mapping[str, int], int]:
        """Counts, and how many of them are trouble."""
        counts = self._generator.counts
        trouble = counts["held"] + counts["tightened"] + counts["stale"]
        return {**counts, "second_opinions": self._generator.second_opinions}, trouble

    def _on_obstacles(self, message: ObstacleStateArray) -> None:
        self.after_first_tick(partial(self._take_obstacles, message), newest_only=True)

    def _take_obstacles(self, message: ObstacleStateArray) -> None:
        """A bad entry is left out with a warning; if it was known, it stays where it was."""
        stamp_ns = nanoseconds_from_time(message.header.stamp)
        if self.waits_for_next_run(stamp_ns, partial(self._take_obstacles, message)):
            return
        if stamp_ns > self.clock.now_ns + self._ahead_ns:
            self.reject(
                "constraints/obstacles.stamp",
                f"{stamp_ns / NANOSECONDS:.6f} s given, at most {self._ahead_ns / NANOSECONDS:g} s"
                f" after the last tick ({self.clock.now_ns / NANOSECONDS:.6f} s) expected",
            )
            return
        if stamp_ns <= self._sensed_ns and stamp_ns > 0:
            if stamp_ns < self._sensed_ns:
                self.reject("constraints/obstacles.stamp", "older than the last one")
            return
        seen: dict[str, Measurement] = {}
        refused = []
        for entry in message.obstacles:
            try:
                seen[entry.id] = measurement_from_message(entry)
            except GhcError as error:
                self.reject("constraints/obstacles", str(error))
                refused.append(entry.id)
        self._sensed_ns = stamp_ns or self.clock.now_ns
        self._generator.observe(list(seen.values()), self._sensed_ns / NANOSECONDS, refused)
        self.look_again()


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal; exit code 0, 1 (failed while running) or 2 (refused)."""
    return run_node(NODE_NAME, ObstacleBoundsNode, args)


if __name__ == "__main__":
    sys.exit(main())
