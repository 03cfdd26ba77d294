"""What the bridge cannot use ends it with one line and exit code 2, before anything runs."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridge_client import EXIT


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        (["scene:=no_such_arm"], ["unknown scene 'no_such_arm'", "kuka_lwr"]),
        (["scene:=/nowhere/scene.yaml"], ["/nowhere/scene.yaml"]),
        ([], ["parameter 'scene'", "is needed"]),
        (["scene:=kuka_lwr", "mode:=warp"], ["'mode'", "lockstep, realtime"]),
        (["scene:=kuka_lwr", "control_dt:=-0.001"], ["'control_dt'", "above 0"]),
        (["scene:=kuka_lwr", "control_dt:=fast"], ["'control_dt'", "'fast'", "a number"]),
        (["scene:=kuka_lwr", "control_dt:=0.0015"], ["0.0015", "0.001", "multiple"]),
        (["scene:=kuka_lwr", "scnee:=x"], ["unknown parameter 'scnee'", "physics_dt"]),
    ],
)
def test_bad_parameter(
    start_node: Callable[..., Any], parameters: list[str], words: list[str]
) -> None:
    pairs = [part for parameter in parameters for part in ("-p", parameter)]
    bridge = start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *pairs)
    assert bridge.wait(EXIT) == 2
    (line,) = bridge.output.strip().splitlines()
    assert line.startswith("sim_bridge: ")
    for word in words:
        assert word in line


def test_malformed_ros_arguments(start_node: Callable[..., Any]) -> None:
    bridge = start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", "-p", "scene")
    assert bridge.wait(EXIT) == 2
    assert "Traceback" not in bridge.output
    assert "sim_bridge: " in bridge.output


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("executor", ["events", "single"])
def test_a_signal_ends_the_bridge_in_order(
    start_node: Callable[..., Any], tmp_path: Path, number: signal.Signals, executor: str
) -> None:
    """Exit code 0, no traceback, and the log of what happened until then."""
    log = tmp_path / "log.npz"
    bridge = start_node(
        "ghc_sim_bridge", "sim_bridge", "--ros-args", "-p", "scene:=kuka_lwr",
        "-p", "mode:=realtime", "-p", f"log_file:={log}", "-p", f"executor:={executor}",
    )  # fmt: skip
    bridge.wait_for_output("running")
    bridge.send(number)
    assert bridge.wait() == 0
    assert "Traceback" not in bridge.output
    assert log.exists()
