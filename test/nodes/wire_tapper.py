"""Somebody on the network as a process: listens, commands and resets for a while, and reports.

`wire_tapper.py SECONDS` prints one line of JSON: joint states received, publishers of them and
readers of commands that were found, the epochs seen, whether a reset was answered.
"""

from __future__ import annotations

import json
import sys
import time

import rclpy
from ghc_msgs.msg import Epoch
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

JOINTS = [f"joint_{i}" for i in range(1, 8)]


def main() -> None:
    """Listen and meddle for the given time [s]."""
    seconds = float(sys.argv[1])
    meddles = "--listen" not in sys.argv
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
    answered = None
    found = {"publishers": 0, "readers": 0}
    end = time.monotonic() + seconds
    while time.monotonic() < end:
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
        "reset": bool(answered is not None and answered.done()),
    }
    print(json.dumps(report), flush=True)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
