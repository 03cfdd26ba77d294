"""The examples run on public names alone and print what they promise."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

import ghc_controller as ghc
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_recording import BagRecording
from ghc_sim_bridge.ros.message_schema import message_schema

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
ARGUMENTS = {"compare_formulations": ["0.1"]}
# What an example may import names from; of the packages these are their public names.
PACKAGES = ("ghc_mpc_constraints", "ghc_sim_bridge", "ghc_controller.reachable")
OTHERS = ("mcap.reader", "mcap_ros2.decoder")  # for recordings
MODULES = (*sys.stdlib_module_names, *PACKAGES, *OTHERS)
PRINTS = {
    "arm_force_control": ["t = 0.5 s:  0.00 N", "t = 5.0 s: 20.00 N at z = 0.2999 m"],
    "arm_own_task": ["error of the distance: 0.0"],
    "arm_swap_priorities": ["t = 8 s: {'end_effector': 0.31", "Nm/s at a period of 1 ms"],
    "arms_carry_together": ["lifted by 100.0 mm and 100.0 mm", "off by at most 0.00"],
    "arms_keep_apart": ["y = 0.000 m and -0.140 m", "bodies.left_hand-right_hand"],
    "compare_formulations": [f"{name} " for name in ghc.FORMULATIONS],
    "configurations": ["joints beyond a limit: none", "end: tool at [0.5, 0.2, 0.6] m"],
    "coupled_joints": ["sum at most 1.7969", "sum at most 1.000", "active: fold"],
    "force_bounds_preview": ["t = 1.0 s: raw 20 N, active 20.0 N", "never looser than raw"],
    "humanoid_lift_foot": ["t = 2 s: foot at 0.010 m", "t = 6 s: foot at 0.060 m,   0.0 N"],
    "obstacle_preview": [
        "t = 1.5 s: wall at 0.60 m, for the controller at 0.61",
        "hand at 0.500 m",
    ],
    "own_constraint": ["0 constraints: nearest 0.0", "1 constraints: nearest 0.080 m, 0.000 m"],
    "own_generator": [
        "t = 1.5 s: limit 0.950 rad, joint 0.94",
        "limit 0.800 rad, joint 0.800 rad",
    ],
    "own_robot_in_python": ["mine: 7 joints", "SOLVED"],
    "read_recording": ["/joint_commands: 200 messages", "left:    2.0 Nm/s", "right:    0.0"],
    "robot_in_mjcf": ["t = 3 s: tip at x = 0.550 m, z = 0.350 m"],
    "teleoperation_stream": ["samples lost, hand 1."],
    "tune_while_running": ["no change        5 Nm/s", "in a second      7 Nm/s"],
    "wipe_a_table": ["t = 3 s: y = 0.143 m, 15.1 N"],
}


def recording(folder: Path) -> Path:
    """200 commands of two joints, at 1 kHz; the torque of the left one rises by 2 Nm/s."""
    bag, topic, kind = BagRecording(folder), "/joint_commands", "sensor_msgs/msg/JointState"
    bag.add_topic(BagTopic(topic, kind, message_schema(kind)))
    for k in range(200):
        message = JointState(name=["left", "right"], effort=[2e-3 * k, 1.0])
        message.header.stamp.nanosec = k * 1_000_000
        bag.write(topic, k * 1_000_000, k, serialize_message(message))
    bag.close()
    return folder


@pytest.mark.parametrize("path", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_examples_run(path: Path, tmp_path: Path) -> None:
    arguments = ARGUMENTS.get(path.stem, [])
    if path.stem == "read_recording":
        arguments = [str(recording(tmp_path / "recording"))]
    command = [sys.executable, str(path), *arguments]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    for words in PRINTS[path.stem]:
        assert words in run.stdout


@pytest.mark.parametrize("path", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_examples_are_short_and_use_public_names(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert 30 <= len(text.splitlines()) <= 60
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            assert node.module in MODULES
        if isinstance(node, ast.Attribute) and getattr(node.value, "id", "") == "ghc":
            assert node.attr in ghc.__all__
