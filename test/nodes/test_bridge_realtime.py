"""The installed bridge by the wall clock: it holds the arm whenever nobody controls it."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bridge_client import ROBOT, BridgeClient, GravityModel, answer

from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.logs.full_rate_log import FullRateLog, Source
from ghc_sim_bridge.run.processes import NodeProcess

RATE_LIMIT = 1000.0  # [Nm/s]
CONTROLLER = Path(__file__).with_name("bridge_client.py")


@pytest.fixture
def start_controller(ros_domain_id: int, tmp_path: Path) -> Iterator[Callable[[], NodeProcess]]:
    """Start a controller that swings the arm, as a process."""
    running: list[NodeProcess] = []

    def start() -> NodeProcess:
        name = f"swing_{len(running)}"
        command = [sys.executable, str(CONTROLLER), "swing"]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
        running.append(NodeProcess(name, command, tmp_path / f"{name}.log", environment))
        return running[-1]

    yield start
    for process in running:
        process.send(signal.SIGKILL)
        process.wait(time.monotonic() + 5.0)


@pytest.fixture
def client(ros_context: Any) -> Iterator[BridgeClient]:
    """A reader on the test's own domain."""
    partner = BridgeClient(ros_context)
    yield partner
    partner.close()


def _parameters(**values: object) -> list[str]:
    values = {"scene": ROBOT, "mode": "realtime"} | values
    return ["--ros-args", *(f for k, v in values.items() for f in ("-p", f"{k}:={v}"))]


def _speed(client: BridgeClient) -> float:
    return float(np.abs(client.next_state().velocity).max())


def _now(client: BridgeClient) -> float:
    """Simulated time of the next state [s]."""
    return nanoseconds_from_time(client.next_state().header.stamp) / NANOSECONDS


def _behind(client: BridgeClient) -> float:
    """Wall time minus simulated time [s], of the promptest of 50 states; its origin is unknown."""
    found = []
    for _ in range(50):
        stamp = _now(client)
        found.append(time.monotonic() - stamp)
    return min(found)


def test_time_follows_the_wall_clock_and_the_arm_is_held(
    start_node: Callable[..., Any], client: BridgeClient
) -> None:
    start_node("ghc_sim_bridge", "sim_bridge", *_parameters())
    first = client.connected_state()
    earlier, begin, began = _behind(client), _now(client), time.monotonic()
    client.spin(1.5)
    simulated, wall = _now(client) - begin, time.monotonic() - began
    # Never ahead; behind only as far as a busy machine makes it drop periods.
    assert _behind(client) > earlier - 0.05
    client.diagnostics.clear()
    client.until(lambda: client.diagnostics, "the diagnostics")
    dropped = int(client.diagnostics["dropped_periods"]) * 1e-3
    assert simulated + dropped > 0.3 * wall
    np.testing.assert_allclose(client.next_state().position, first.position, atol=1e-9)


def test_killed_controller_and_the_next_one(
    start_node: Callable[..., Any],
    start_controller: Callable[[], NodeProcess],
    client: BridgeClient,
    tmp_path: Path,
) -> None:
    """The arm comes to rest, and neither kill nor take-over is a jump of the torque."""
    file = tmp_path / "log.npz"
    bridge = start_node(
        "ghc_sim_bridge", "sim_bridge",
        *_parameters(log_file=file, torque_rate_limit=RATE_LIMIT, watchdog_timeout=0.05),
    )  # fmt: skip
    client.connected_state()
    for _ in range(2):
        controller = start_controller()
        client.until(lambda: _speed(client) > 0.2, "a moving arm")
        controller.send(signal.SIGKILL)
        killed = _now(client)
        client.until(lambda: _now(client) > killed + 1.0, "a second of the robot's time")  # noqa: B023
        assert _speed(client) < 0.5
        client.until(lambda: _speed(client) < 1e-3, "an arm at rest")
        client.until(lambda: client.diagnostics.get("holding") == "True", "'holding'")
    assert bridge.stop() == 0
    log = FullRateLog.load(file)
    np.testing.assert_allclose(np.diff(log.time), 1e-3, atol=1e-9)
    assert np.abs(np.diff(log.torque, axis=0)).max() <= RATE_LIMIT * log.control_dt + 1e-9
    held = log.source == Source.HOLD
    changes = np.flatnonzero(np.diff(held.astype(int)))
    assert held[0] and held[-1]
    assert len(changes) >= 4, "held, driven, held, driven, held"


def test_commands_for_old_states_do_not_wake_the_arm(
    start_node: Callable[..., Any], client: BridgeClient
) -> None:
    start_node("ghc_sim_bridge", "sim_bridge", *_parameters())
    first = client.connected_state()
    client.until(
        lambda: (
            nanoseconds_from_time(client.next_state().header.stamp)
            > nanoseconds_from_time(first.header.stamp) + 100_000_000
        ),
        "a state 0.1 s later",
    )
    stale = answer(first, GravityModel().hold(first) + 20.0)
    for _ in range(20):
        client.commands.publish(stale)
        client.spin(0.01)
    client.counted("stale", 1, again=lambda: client.commands.publish(stale))
    assert _speed(client) < 1e-6


def test_pause_stops_time_and_resume_holds(
    start_node: Callable[..., Any], client: BridgeClient
) -> None:
    start_node("ghc_sim_bridge", "sim_bridge", *_parameters())
    client.connected_state()
    client.pause(True)
    client.spin(0.2)  # what was on its way comes
    stamp = client.next_state().header.stamp
    client.spin(0.5)
    assert client.next_state().header.stamp == stamp
    client.pause(False)
    client.until(lambda: client.next_state().header.stamp != stamp, "time to go on")
    before = nanoseconds_from_time(client.next_state().header.stamp)
    assert client.reset().startswith("epoch 1 from t = ")
    client.until(lambda: client.epochs[-1].number == 1, "epoch 1")
    start = nanoseconds_from_time(client.epochs[-1].start)
    assert start > before + NANOSECONDS
    client.until(
        lambda: nanoseconds_from_time(client.next_state().header.stamp) >= start, "its states"
    )
