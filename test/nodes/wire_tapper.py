"""Somebody on the network as a process: listens, commands and resets for a while, and reports.

`wire_tapper.py SECONDS [--patience SECONDS] [--listen]` prints one line of JSON: joint states
received, publishers of them and readers of commands that were found, the epochs seen, whether a
reset was answered. With patience it goes on until it has seen all of that.
"""

from __future__ import annotations

import argparse
import json
import time

import rclpy
from ghc_msgs.msg import Epoch
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

JOINTS = [f"joint_{i}" for i in range(1, 8)]
ENOUGH = 100  # [-] states


def main() -> None:
    """Listen and meddle for the given time [s]."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seconds", type=float)
    parser.add_argument("--patience", type=float, default=0.0)
    parser.add_argument("--listen", action="store_true", help="and do nothing else")
    options = parser.parse_args()
    meddles = not options.listen
    rclpy.init(args=[])
    node = Node("tapper")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    states: list[JointState] = []
    epochs: list[Epoch] = []
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    node.create_subscription(JointState, "joint_states", states.append, qos)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(Epoch, "sim_bridge/epoch", epochs.append, latched)
    commands = node.create_publisher(JointState, "joint_commands", 1) if meddles else None
    reset = node.create_client(Trigger, "sim_bridge/reset")
    answered: Future | None = None
    found = {"publishers": 0, "readers": 0}
    begun = time.monotonic()

    def goes_on() -> bool:
        taken = time.monotonic() - begun
        all_seen = len(states) > ENOUGH and epochs and (not meddles or reset_is_done())
        return taken < options.seconds or (taken < options.patience and not all_seen)

    def reset_is_done() -> bool:
        return answered is not None and answered.done()

    while goes_on():
        executor.spin_once(timeout_sec=0.005)
        found["publishers"] = max(found["publishers"], node.count_publishers("joint_states"))
        found["readers"] = max(found["readers"], node.count_subscribers("joint_commands"))
        if commands is not None:
            message = JointState(name=JOINTS, effort=[20.0] * 7)
            if states:
                message.header = states[-1].header
            commands.publish(message)
            if answered is None and reset.service_is_ready():
                answered = reset.call_async(Trigger.Request())
    report = {
        **found,
        "states": len(states),
        "epochs": [epoch.number for epoch in epochs],
        "reset": reset_is_done(),
    }
    print(json.dumps(report), flush=True)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
