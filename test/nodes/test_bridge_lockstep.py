"""The installed bridge in lockstep: it steps on the right command and on nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bridge_client import DEADLINE, EXIT, ROBOT, BridgeClient, GravityModel, answer
from geometry_msgs.msg import WrenchStamped
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from ghc_controller.ros.qos import CLOCK_QOS
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_sim_bridge.logs.full_rate_log import FullRateLog, Source

PLANE_SCENE = "kuka_lwr_plane"
TIMEOUT = 3.0  # [s] wall, of a bridge without an answer; this client answers sooner
StartBridge = Callable[..., Any]


@pytest.fixture
def start_bridge(start_node: Callable[..., Any]) -> StartBridge:
    """Start the bridge with parameters given by keyword; its rate limit is off by default."""

    def start(**parameters: object) -> Any:
        values = {"scene": ROBOT, "torque_rate_limit": 0.0, "lockstep_timeout": DEADLINE}
        values |= parameters
        arguments = [f"{name}:={value}" for name, value in values.items()]
        pairs = [part for argument in arguments for part in ("-p", argument)]
        return start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *pairs)

    return start


@pytest.fixture
def client(ros_context: Any) -> Iterator[BridgeClient]:
    """A partner on the test's own domain."""
    partner = BridgeClient(ros_context)
    yield partner
    partner.close()


def _stamp(state: JointState) -> int:
    return nanoseconds_from_time(state.header.stamp)


def _walk(client: BridgeClient, steps: int, model: GravityModel | None = None) -> list[JointState]:
    """Swing the arm; with its model made before, no state waits for that."""
    model = model or GravityModel()
    states = [client.connected_state()]
    for _ in range(steps):
        states.append(client.step(states[-1], model.swing(states[-1])))
    return states


def test_two_runs_give_the_same_trajectory(
    start_bridge: StartBridge, client: BridgeClient, tmp_path: Path
) -> None:
    logs = []
    for run in range(2):
        file = tmp_path / f"log_{run}.npz"
        client.alone()
        bridge = start_bridge(log_file=file, stop_time=0.2)
        states = _walk(client, 200)
        assert [_stamp(state) for state in states] == [k * 1_000_000 for k in range(201)]
        client.until(file.exists, "the log, as soon as stop_time is reached")
        assert bridge.stop() == 0
        assert "Traceback" not in bridge.output
        logs.append(FullRateLog.load(file))
    assert logs[0].time.shape == (200,)
    assert (logs[0].source == Source.COMMAND).all()
    assert np.abs(logs[0].v).max() > 0.1, "the arm moved"
    for name in ("q", "v", "torque", "acceleration"):
        np.testing.assert_allclose(
            getattr(logs[0], name), getattr(logs[1], name), rtol=0.0, atol=1e-9
        )


def test_state_carries_the_torque_that_led_to_it(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    start_bridge()
    first = client.connected_state()
    np.testing.assert_allclose(first.effort, GravityModel().hold(first), atol=1e-9)
    torque = np.array(first.effort) + 0.25
    second = client.step(first, torque)
    np.testing.assert_array_equal(second.effort, torque)
    assert second.header.frame_id == first.header.frame_id == ""


def test_no_step_without_its_command_and_a_lost_answer_is_asked_for_again(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    start_bridge()
    state = client.connected_state()
    client.states.clear()
    client.until(lambda: len(client.states) >= 4, "an unanswered state is repeated")
    assert all(repeat == state for repeat in client.states)
    late = answer(state, state.effort)
    late.header.stamp.nanosec = 500_000_000
    client.commands.publish(late)
    client.counted("stamp_of_no_state", 1, again=lambda: client.commands.publish(late))
    assert _stamp(client.next_state()) == 0
    moved = client.step(state, state.effort)
    assert _stamp(moved) == 1_000_000
    again = answer(state, state.effort)
    client.commands.publish(again)
    client.counted("answered_before", 1, again=lambda: client.commands.publish(again))
    assert _stamp(client.next_state()) == 1_000_000, "a repeated answer does not step again"


def test_clock_follows_the_states(
    start_bridge: StartBridge, client: BridgeClient, ros_context: Any
) -> None:
    clocks: list[int] = []
    client.node.create_subscription(
        Clock, "/clock", lambda m: clocks.append(nanoseconds_from_time(m.clock)), CLOCK_QOS
    )
    start_bridge(control_dt=0.002, physics_dt=0.0005)
    states = _walk(client, 20)
    assert _stamp(states[-1]) == 40_000_000
    client.until(lambda: clocks and clocks[-1] == 40_000_000, "the clock of the last state")
    assert clocks == sorted(clocks)


def test_contact_wrenches_come_with_the_state_of_their_stamp(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    """Whoever has the state can have the wrench: it was sent before."""
    wrenches: dict[int, WrenchStamped] = {}
    client.node.create_subscription(
        WrenchStamped,
        "contacts/tool",
        lambda m: wrenches.update({nanoseconds_from_time(m.header.stamp): m}),
        10,
    )
    start_bridge(scene=PLANE_SCENE)
    client.until(lambda: wrenches, "a first wrench")
    state = client.connected_state()
    for k in range(20):
        state = client.step(state, state.effort)
        client.until(lambda: _stamp(state) in wrenches, f"the wrench of period {k}")  # noqa: B023
    assert {message.header.frame_id for message in wrenches.values()} == {"world"}
    assert sorted(wrenches) == [k * 1_000_000 for k in range(21)]


def test_contacts_can_be_left_out(start_bridge: StartBridge, client: BridgeClient) -> None:
    start_bridge(scene=PLANE_SCENE, publish_contacts="false")
    client.connected_state()
    topics = {name for name, _ in client.node.get_topic_names_and_types()}
    assert "/joint_states" in topics
    assert not [name for name in topics if "contacts" in name]


@pytest.mark.parametrize("executor", ["events", "single"])
def test_missing_controller_is_a_clear_error(start_bridge: StartBridge, executor: str) -> None:
    bridge = start_bridge(lockstep_timeout=0.5, executor=executor)
    assert bridge.wait(EXIT) == 1
    line = bridge.output.strip().splitlines()[-1]
    assert "Traceback" not in bridge.output
    assert line.startswith(
        "sim_bridge: no command on 'joint_commands' answered the state of t = 0"
    )
    assert "controller running" in line


def test_controller_that_falls_silent_is_a_clear_error(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    bridge = start_bridge(paused=True, lockstep_timeout=TIMEOUT)
    client.connected_state()
    model = GravityModel()
    client.pause(False)
    state = _walk(client, 5, model)[-1]
    broken = answer(state, state.effort)
    broken.effort[2] = float("nan")
    client.commands.publish(broken)
    assert bridge.wait(EXIT) == 1
    assert "t = 0.005000 s" in bridge.output
    assert "the last one was rejected: effort: joint_3 is nan" in bridge.output
    assert "Traceback" not in bridge.output


def test_commands_that_cannot_be_used_are_counted_and_do_no_harm(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    bridge = start_bridge()
    state = client.connected_state()
    good = answer(state, state.effort)
    for key, count, names, effort in (
        ("effort", 1, state.name, [float("nan")] * 7),
        ("effort", 2, state.name, list(state.effort)[:3]),
        ("name", 1, list(state.name)[:6], list(state.effort)[:6]),
        ("name", 2, [*list(state.name)[:6], "gripper"], state.effort),
    ):
        command = JointState(header=good.header, name=names, effort=effort)
        client.commands.publish(command)
        client.counted(key, count, again=lambda: client.commands.publish(command))  # noqa: B023
    assert _stamp(client.next_state()) == 0
    assert _stamp(client.step(state, state.effort)) == 1_000_000
    assert "joint_commands: effort: joint_1 is nan" in bridge.output
    assert bridge.stop() == 0
    assert "Traceback" not in bridge.output


def test_torque_beyond_the_limits_is_clipped_and_counted(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    start_bridge(torque_rate_limit=1000.0)
    state = client.connected_state()
    wild = client.step(state, [1e4, -1e4, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert np.abs(np.subtract(wild.effort, state.effort)).max() <= 1.0 + 1e-9
    client.counted("torque_limit", 1)
    client.counted("torque_rate", 1)
    for _ in range(200):
        wild = client.step(wild, [1e4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert wild.effort[0] == pytest.approx(176.0)


def test_reset_goes_to_the_start_in_a_new_epoch(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    start_bridge()
    states = _walk(client, 30)
    assert client.reset() == "epoch 1 from t = 2.000000 s on"
    start = 2_000_000_000
    client.until(lambda: _stamp(client.next_state()) == start, "the next run")
    client.until(lambda: len(client.epochs) >= 2, "both epochs")
    assert [(epoch.number, epoch.start.sec) for epoch in client.epochs] == [(0, 0), (1, 2)]
    state = client.next_state()
    np.testing.assert_array_equal(state.position, states[0].position)
    late = answer(states[-1], state.effort)  # of the run before
    for _ in range(10):
        client.commands.publish(late)
        client.spin(0.02)
    client.counted("answered_before", 1, again=lambda: client.commands.publish(late))
    assert _stamp(client.next_state()) == start
    assert _stamp(client.step(state, state.effort)) == start + 1_000_000


def test_pause_stops_time_and_waits_for_ever(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    bridge = start_bridge(paused=True, lockstep_timeout=TIMEOUT)
    state = client.connected_state()
    client.commands.publish(answer(state, state.effort))
    client.spin(TIMEOUT + 0.5)
    assert bridge.exit_code is None
    assert {_stamp(repeat) for repeat in client.states} == {0}
    assert client.pause(False) == "running at t = 0.000000 s"
    state = client.step(client.next_state(), state.effort)
    assert client.pause(True).startswith("paused")
    client.spin(TIMEOUT + 0.5)
    assert bridge.exit_code is None
    assert _stamp(client.next_state()) == _stamp(state)


def test_after_the_stop_time_the_last_state_stays_readable(
    start_bridge: StartBridge, client: BridgeClient
) -> None:
    bridge = start_bridge(stop_time=0.005, paused=True, lockstep_timeout=TIMEOUT)
    client.connected_state()
    model = GravityModel()
    client.pause(False)
    last = _walk(client, 5, model)[-1]
    client.commands.publish(answer(last, last.effort))
    client.spin(TIMEOUT + 0.5)
    assert _stamp(client.next_state()) == 5_000_000
    assert bridge.exit_code is None
    assert bridge.stop() == 0
