"""The viewer beside a running bridge, and the process of Rerun's own viewer."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import rerun as rr
from bridge_client import DEADLINE, ROBOT, BridgeClient, GravityModel
from browser import CHROMIUM, Browser
from ghc_msgs.msg import ControllerState, TaskState

from ghc_sim_bridge.viewer.layout import new_recording
from ghc_sim_bridge.viewer.page_keeper import browsers
from ghc_sim_bridge.viewer.process import start_viewer


@pytest.fixture
def client(ros_context: Any) -> Iterator[BridgeClient]:
    """The bridge's partner on the test's own domain."""
    partner = BridgeClient(ros_context)
    yield partner
    partner.close()


def _entities(path: Path) -> set[str]:
    run = subprocess.run(
        [sys.executable, "-m", "rerun", "rrd", "stats", str(path)],
        check=True,
        capture_output=True,
        text=True,
    )
    return {line.partition(":")[0] for line in run.stdout.splitlines() if line.startswith("/")}


def _has_begun(file: Path) -> bool:
    """Whether a state and a report have come to the file, which is still written."""
    data = file.read_bytes() if file.exists() else b""
    return b"/world/robot/joint_7" in data and b"/world/targets/end_effector" in data


def test_viewer_shows_states_and_reports(
    start_node: Callable[..., Any], client: BridgeClient, tmp_path: Path
) -> None:
    file = tmp_path / "live.rrd"
    reports = client.node.create_publisher(ControllerState, "ghc/controller_state", 10)
    scene = ("-p", f"scene:={ROBOT}", "-p", f"lockstep_timeout:={DEADLINE}")
    start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *scene)
    viewer = start_node(
        "ghc_sim_bridge", "viewer", "--ros-args", "-p", f"scene:={ROBOT}", "-p", f"output:={file}"
    )
    client.until(lambda: client.node.count_subscribers("joint_states") >= 2, "the viewer")
    client.until(lambda: reports.get_subscription_count() > 0, "the viewer's subscription")
    model = GravityModel()
    state = client.connected_state()
    # Until it shows them, however late the bridge's messages begin to reach it.
    deadline = time.monotonic() + DEADLINE
    while not _has_begun(file):
        assert time.monotonic() < deadline, viewer.output
        report = ControllerState(alpha=[0.0, 1.0, 0.0, 0.0])
        report.header.stamp = state.header.stamp
        report.tasks = [
            TaskState(name="end_effector", error=[0.1, 0.0, 0.0], reference=[0.4, 0.0, 0.5]),
            TaskState(name="posture", error=[0.1] * 7, reference=[0.0] * 7),
        ]
        reports.publish(report)
        state = client.step(state, model.swing(state))
    assert viewer.stop() == 0
    assert "Traceback" not in viewer.output
    found = _entities(file)
    assert {
        "/world/robot/joint_1", "/world/robot/joint_7", "/world/targets/end_effector",
        "/plots/torque", "/plots/torque_rate", "/plots/alpha", "/plots/task_error",
    } <= found  # fmt: skip
    assert "/world/targets/posture" not in found


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({}, ["'scene'", "is needed"]),
        ({"scene": "no_such_arm"}, ["unknown scene 'no_such_arm'"]),
        ({"scene": ROBOT, "robot": "no_such_robot"}, ["unknown robot 'no_such_robot'"]),
        ({"scene": ROBOT, "display": "wall"}, ["'display'", "auto, window, browser"]),
    ],
)
def test_what_cannot_be_used_is_one_clear_line(
    start_node: Callable[..., Any], parameters: dict[str, str], words: list[str]
) -> None:
    pairs = [part for k, v in parameters.items() for part in ("-p", f"{k}:={v}")]
    viewer = start_node("ghc_sim_bridge", "viewer", "--ros-args", *pairs)
    assert viewer.wait() == 2
    (line,) = viewer.output.strip().splitlines()
    assert all(word in line for word in ["viewer: ", *words])


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="reads Linux' table of sockets")
def test_served_page_is_reachable_from_this_machine_only() -> None:
    viewer = start_viewer(window=False)
    try:
        ports = {int(part.partition("/")[0]) for part in viewer.url.split(":")[2:]}
        ports |= {int(viewer.page.split(":")[2].partition("/")[0])}
        assert len(ports) == 2
        assert {port: _listeners(port) for port in ports} == {
            port: {"127.0.0.1"} for port in ports
        }
    finally:
        viewer.end()
    deadline = time.monotonic() + 60.0
    while any(_listeners(port) for port in ports):
        assert time.monotonic() < deadline, "the server outlives its end"
        time.sleep(0.1)


@pytest.mark.long
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_the_page_stays_until_the_browser_is_closed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The node leaves; the viewer serves on for 5 s, until the browser with its page ends."""
    monkeypatch.setattr("ghc_sim_bridge.viewer.process.PAGE_PATIENCE", 2.0)
    viewer = start_viewer(window=False)
    recording = new_recording()
    recording.connect_grpc(viewer.url)
    recording.log("plots/torque", rr.Scalars([1.0]))
    recording.flush()
    port = int(viewer.url.rpartition(":")[2].partition("/")[0])
    try:
        with Browser(viewer.page, tmp_path) as browser:
            recording.disconnect()
            deadline = time.monotonic() + 60.0
            while not browsers(port):
                assert time.monotonic() < deadline, browser.value("document.body.innerText")
                time.sleep(0.1)
            viewer.leave()
            time.sleep(5.0)
            assert viewer.process.poll() is None
            assert browser.value("document.title")
        viewer.process.wait(60.0)
    finally:
        viewer.end()


def _listeners(port: int) -> set[str]:
    """Addresses on which somebody listens at `port`."""
    found = set()
    for file in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in Path(file).read_text(encoding="utf-8").splitlines()[1:]:
            _, local, _, state = line.split()[:4]
            address, _, number = local.partition(":")
            if int(number, 16) == port and state == "0A":  # listening
                octets = bytes.fromhex(address)[::-1]
                found.add(".".join(map(str, octets)) if len(octets) == 4 else address)
    return found
