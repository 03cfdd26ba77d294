"""Part of the bridge node: checks and counts commands, accepts one commander.

Subscribes joint_commands.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState

from ghc_controller.errors import GhcError
from ghc_controller.ros.conversions.states import read_joint_state
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.rejections import BRIDGE, Rejections, warning
from ghc_controller.ros.run import guarded, tolerant
from ghc_controller.safety.torque_gate import GatedTorque
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.bridge.command_claim import CommandClaim
from ghc_sim_bridge.bridge.commands import CommandDecoder, CommandRejected
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.diagnostics import EXPECTED
from ghc_sim_bridge.bridge.run_mode import RunMode
from ghc_sim_bridge.ros.others import publishers_of

TOPIC = "joint_commands"


class CommandSubscriber:
    """Passes commands to the run mode, and reports why one was not used."""

    def __init__(self, node: Node, cycle: ControlCycle) -> None:
        """No commands yet; `listen` subscribes."""
        self.rejections = Rejections()
        self.refusal = ""  # why the last command was rejected; empty after a good one
        self._node = node
        self._cycle = cycle
        self._claim = CommandClaim()
        self._decoder = CommandDecoder(cycle.simulator.joint_names, read_joint_state)

    def listen(self, mode: RunMode, used: Callable[[], None], stop: Future) -> None:
        """Subscribe.

        Args:
            mode: receiver of checked commands.
            used: called for each command that was used.
            stop: ends the node with an error of the simulation or the disk, never of a message.
        """

        def take(data: bytes) -> None:
            if self._take(data, mode):
                used()

        callback = tolerant(take, "message", self._reject, (GhcError, OSError))
        self._node.create_subscription(
            JointState, TOPIC, guarded(stop, callback), CONTROL_SUBSCRIBER_QOS, raw=True
        )

    def applied(self, gated: GatedTorque) -> None:
        """Count what the gate had to clip."""
        if gated.limit_hit:
            self._reject("torque_limit", "effort beyond the torque limits given")
        if gated.rate_hit:
            self._reject("torque_rate", "effort beyond the torque rate limit given")

    def _take(self, data: bytes, mode: RunMode) -> bool:
        """Whether a serialized command was used."""
        try:
            stamp_ns, torque, sender = self._decoder.decode(data)
        except CommandRejected as error:
            self.refusal = str(error)
            self._reject(error.field, self.refusal)
            return False
        if self._claim.blocks(sender, time.monotonic()):
            self._ignore(sender)
            return False
        # In lockstep no hold is active meanwhile: a controller restarted in motion would be #
        # rejected indefinitely. The gate limits the change of torque.
        jumps = not mode.waits and not self._cycle.continues(torque)
        if self._claim.takes_over(sender) and jumps:
            self.refusal = (
                f"sender '{sender}' given, whose torque is far from the applied one; to take "
                "over it has to be near: two periods of the rate limit"
            )
            self._reject("takeover", self.refusal)
            return False
        now_ns = self._cycle.time_ns
        unwanted = mode.command(stamp_ns, torque)
        self._claim.heard(sender, time.monotonic(), used=not unwanted)
        if unwanted:
            given, now = stamp_ns / NANOSECONDS, now_ns / NANOSECONDS
            self._reject(unwanted, f"stamp {given:.6f} s given at t = {now:.6f} s ({unwanted})")
            return False
        self.refusal = ""
        return True

    def _ignore(self, sender: str) -> None:
        """A second commander: count it, with a rate-limited warning."""
        if self.rejections.count("second_commander", time.monotonic()):
            self._node.get_logger().warning(
                f"{TOPIC}: sender '{sender}' ignored while '{self._claim.sender}' commands "
                f"the robot; publishers: {', '.join(publishers_of(self._node, TOPIC))}"
            )

    def _reject(self, field: str, reason: str) -> None:
        warn = self.rejections.count(field, time.monotonic())
        if warn and field not in EXPECTED:
            self._node.get_logger().warning(f"{TOPIC}: {warning(field, reason, BRIDGE)}")
