"""Faults of processes: killed, stopped, started twice."""

from __future__ import annotations

import resource
import shutil
import signal
import time
from functools import partial
from pathlib import Path

import numpy as np
from mcap.records import Channel, Message

from benchmarks.faults.row import Bench, Limits, Row, nothing
from benchmarks.faults.session import Session
from ghc_sim_bridge.recorder.bag_reading import intact_records, read_messages

RESTART = 30.0  # [s] wall
KILLED = Limits(hold=0.020, recovery=RESTART)
STATES = "/joint_states"
STOPS = (0.005, 0.05, 0.5, 5.0)  # [s]


def kill_and_restart(name: str, session: Session, _: np.random.Generator) -> None:
    """SIGKILL, 0.8 s of nothing, a new process."""
    session.kill(name)
    session.spin(0.8)
    session.start(name)
    session.ready()


def freeze(name: str, seconds: float, session: Session, _: np.random.Generator) -> None:
    """SIGSTOP for a while."""
    session.processes[name].send(signal.SIGSTOP)
    session.spin(seconds)
    session.processes[name].send(signal.SIGCONT)


def _recorded(bag: Path) -> bool:
    """Whether joint states are on the disk already."""
    records = [record for file in bag.glob("*.mcap") for record in intact_records(file)]
    channels = {one.id for one in records if isinstance(one, Channel) and one.topic == STATES}
    return any(isinstance(one, Message) and one.channel_id in channels for one in records)


def full_disk(session: Session, _: np.random.Generator) -> None:
    """A recorder whose file may not grow any more: what it has by then has to be readable."""
    bag = session.folder / f"bag_{time.monotonic_ns()}"
    process = session.start("recorder", output=bag, record_mode="full")
    end = time.monotonic() + RESTART
    while not _recorded(bag):
        if time.monotonic() > end:
            raise AssertionError(f"no message was recorded within {RESTART:g} s")
        session.swing(0.5)
    (file,) = bag.glob("*.mcap")
    most = file.stat().st_size + 20_000
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (most, most))
    end = time.monotonic() + RESTART
    while "recording ends here" not in session.output("recorder"):
        if time.monotonic() > end:
            raise AssertionError("the recorder does not tell that the disk is full")
        session.swing(0.5)
    session.stop("recorder")
    kept = sum(1 for _ in read_messages(bag, "sensor_msgs/msg/JointState"))
    shutil.rmtree(bag)
    if not kept:
        raise AssertionError("nothing can be read of what was recorded before")


def second_controller(session: Session, _: np.random.Generator) -> None:
    """Another controller with another hierarchy."""
    session.start("second", "controller", hierarchy="posture > elbow > end_effector")
    session.spin(6.0)
    session.swing(1.0)
    session.stop("second")


def second_bridge(session: Session, _: np.random.Generator) -> None:
    """Another bridge of the same robot: it has to end on its own."""
    second = session.start("second", "sim_bridge")
    ended = second.wait(time.monotonic() + 20.0)
    session.processes.pop("second")
    if not ended:
        second.send(signal.SIGKILL)
        raise AssertionError("the second bridge runs")


ROWS = (
    Row("baseline at rest", nothing, "process", moving=False, quick=True),
    Row("baseline moving", nothing, "process", quick=True),
    Row("baseline moving, 1 kHz", nothing, "process", bench=Bench.FAST, after=4.0),
    *(
        Row(
            f"controller kill -9, {'in fast motion' if moving else 'at rest'}",
            partial(kill_and_restart, "controller"),
            "process",
            moving=moving,
            limits=KILLED if moving else Limits(recovery=RESTART),
            quick=moving,
        )
        for moving in (False, True)
    ),
    Row(
        "controller kill -9, in fast motion, 1 kHz",
        partial(kill_and_restart, "controller"),
        "process",
        bench=Bench.FAST,
        limits=KILLED,
    ),
    *(
        Row(
            f"{name} SIGSTOP {1e3 * seconds:g} ms",
            partial(freeze, name, seconds),
            "process",
            quick=seconds == 0.05,
        )
        for name in ("controller", "sim_bridge")
        for seconds in STOPS
    ),
    Row("recorder: disk full", full_disk, "process", quick=True),
    Row("two controllers, other hierarchy", second_controller, "process"),
    Row("two bridges, one controller", second_bridge, "process", quick=True),
)
