"""Resets at any time: no stamp goes back, no node dies, the next transition works."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from ghc_msgs.msg import ControllerState, Epoch, PriorityMatrix, TransitionStatus
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from std_srvs.srv import SetBool, Trigger

from benchmarks.faults.session import PATIENCE, Session
from ghc_controller.ros.qos import CLOCK_QOS, CONTROL_SUBSCRIBER_QOS, LATCHED_QOS, STREAM_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_controller.types import NANOSECONDS

# A queue for a whole run in lockstep, however late this reader is.
EVERY = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
HOME = "end_effector > elbow > posture"
OTHER = "elbow > posture"


class Stamps:
    """All stamps by topic, and the runs that were announced."""

    def __init__(self, session: Session) -> None:
        self.heard: dict[str, list[int]] = {}
        self.epochs: list[Epoch] = []
        topics: tuple[tuple[type, str, Any], ...] = (
            (JointState, "joint_states", CONTROL_SUBSCRIBER_QOS),
            (JointState, "joint_commands", CONTROL_SUBSCRIBER_QOS),
            (Clock, "/clock", CLOCK_QOS),
            (ControllerState, "ghc/controller_state", STREAM_QOS),
            (PriorityMatrix, "ghc/priority_matrix", LATCHED_QOS),
        )
        for kind, topic, qos in topics:
            note = partial(self._note, self.heard.setdefault(topic, []))
            session.node.create_subscription(kind, topic, note, qos)
        session.node.create_subscription(
            Epoch, "sim_bridge/epoch", self.epochs.append, LATCHED_QOS
        )

    @staticmethod
    def _note(heard: list[int], message: Any) -> None:
        stamp = message.clock if isinstance(message, Clock) else message.header.stamp
        heard.append(nanoseconds_from_time(stamp))


def _start(session: Session, mode: str, **bridge: Any) -> None:
    lockstep = mode == "lockstep"
    session.start("sim_bridge", mode=mode, lockstep_timeout=PATIENCE, **bridge)
    session.start("controller", lockstep=lockstep, arming="automatic", bounds_step=0.01)
    # Not its report: of a paused robot there is one alone, which may be there before its reader.
    session.until(lambda: session.command is not None, "a command of the controller")
    session.until(session.transitions.get_subscription_count, "a reader of transitions")


@pytest.mark.parametrize("mode", ["lockstep", "realtime"])
def test_a_hundred_resets_in_a_second(tmp_path: Path, mode: str) -> None:
    with Session(tmp_path) as session:
        stamps = Stamps(session)
        _start(session, mode)
        session.ready()
        reset = session.node.create_client(Trigger, "sim_bridge/reset")
        session.until(reset.service_is_ready, "the service")
        for _ in range(100):
            answer = reset.call_async(Trigger.Request())
            session.spin(0.01)
            session.until(answer.done, "its answer")
        session.until(lambda: stamps.epochs[-1:] and stamps.epochs[-1].number == 100, "run 100")
        start = nanoseconds_from_time(stamps.epochs[-1].start)
        session.until(lambda: stamps.heard["joint_commands"][-1] > start, "a command of run 100")
        assert session.ask(HOME, 0.05).status == TransitionStatus.ACCEPTED
        session.ask_with_id("next", OTHER)
        done = (TransitionStatus.DONE, "next")
        session.until(lambda: done in [(s.status, s.id) for s in session.statuses], "its end")
        for topic, heard in stamps.heard.items():
            assert len(heard) > 1, topic
            assert (np.diff(heard) >= 0).all(), topic
        assert [process.exit_code for process in session.processes.values()] == [None, None]


def test_a_run_in_lockstep_is_the_same_after_a_reset(tmp_path: Path) -> None:
    """A script with times of the run: commands and states to 1e-9, at the same times."""
    with Session(tmp_path) as session:
        _start(session, "lockstep", paused=True, stop_time=0.4)
        stamps = Stamps(session)
        session.until(lambda: stamps.epochs, "the first run")
        states: dict[int, list[float]] = {}
        session.node.create_subscription(JointState, "joint_states", partial(_keep, states), EVERY)
        runs = []
        for number in range(2):
            _pause(session, True)  # before the reset: the run would be on its way
            if number:
                session.call("sim_bridge/reset")
                session.until(lambda: stamps.epochs[-1].number == 1, "the second run")
            start = nanoseconds_from_time(stamps.epochs[-1].start)
            _run(session, states, start)
            run = {t - start: values for t, values in states.items() if t >= start}
            runs.append(run)
        common = sorted(runs[0].keys() & runs[1].keys())
        assert len(common) > 20  # of 201: a reader that is late hears only the newest one
        assert max(common) == round(0.4 * NANOSECONDS)
        difference = [np.subtract(runs[0][t], runs[1][t]) for t in common]
        assert np.abs(difference).max() < 1e-9
        assert np.abs(np.subtract(runs[0][common[0]], runs[0][common[-1]])).max() > 1e-3


def _run(session: Session, states: dict[int, list[float]], start: int) -> None:
    """From a paused start to the stop time, with a transition at 0.1 s of the run."""
    session.until(lambda: start in states, "the first state")
    stamp = time_from_nanoseconds(start + NANOSECONDS // 10)
    name = f"run {start}"
    status = session.ask(OTHER, 0.1, id=name, header=Header(stamp=stamp))
    assert (status.id, status.status) == (name, TransitionStatus.ACCEPTED)
    _pause(session, False)
    end = start + round(0.4 * NANOSECONDS)
    session.until(lambda: end in states, "the end of the run", 120.0)


def _pause(session: Session, paused: bool) -> None:
    client = session.node.create_client(SetBool, "sim_bridge/pause")
    session.until(client.service_is_ready, "the service")
    answer = client.call_async(SetBool.Request(data=paused))
    session.until(answer.done, "its answer")


def _keep(states: dict[int, list[float]], message: JointState) -> None:
    stamp: Time = message.header.stamp
    states[nanoseconds_from_time(stamp)] = [*message.position, *message.velocity, *message.effort]
