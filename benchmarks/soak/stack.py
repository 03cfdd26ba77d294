"""The whole stack for an hour of simulated time: random requests, inputs and kills.

`make soak ARGS="--stack --hours 1"`. Bridge in lockstep, controller, both generators and recorder;
one of the three in the middle is killed now and then and started again. Resident memory of every
process is judged from minute 5 of its life on, and every state has to be in the recording.
"""

from __future__ import annotations

import argparse
import math
import shutil
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from ghc_msgs.msg import ContactSchedule as ContactScheduleMessage
from ghc_msgs.msg import ObstacleStateArray
from std_srvs.srv import SetBool

import ghc_controller as ghc
from benchmarks.faults.session import Session
from benchmarks.soak.memory import GROWTH_GOAL, resident_memory
from benchmarks.soak.stack_page import write_stack_section
from ghc_controller.report.valid_json import json_text
from ghc_controller.ros.qos import SCHEDULE_QOS, SENSOR_PUBLISHER_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints import ContactSchedule, Measurement
from ghc_mpc_constraints.ros.conversions import measurement_message, schedule_message
from ghc_sim_bridge.recorder.bag_reading import raw_messages, read_messages

ROOT = Path(__file__).resolve().parents[2]
CONTROL_DT = 5e-3  # [s]
KILLED = ("controller", "obstacle_bounds", "contact_force_bounds")
NODES = ("recorder", *KILLED)
ORDERS = ("end_effector > elbow > posture", "elbow > end_effector > posture", "posture > elbow")
QUICK_LENGTH = 10.0  # [s] simulated
_PATIENCE = 120.0  # [s] wall, without any progress of simulated time
_SAMPLE = 5.0  # [s] simulated
_ACT = 0.5  # [s] simulated, between two random inputs
_LEAST_LIFE = 60.0  # [s] simulated, beyond the warm-up: below, growth says nothing


@dataclass(slots=True)
class Life:
    """Resident memory of one process, from its start to its end."""

    node: str
    times: list[float] = field(default_factory=list)  # [s] simulated, since its start
    resident: list[float] = field(default_factory=list)  # [MB]

    def growth(self, warm_up: float) -> float | None:
        """MB per hour after the warm-up, by a line; None where it did not live so long."""
        times, values = np.array(self.times), np.array(self.resident)
        kept = times >= warm_up
        if not kept.any() or times[-1] - warm_up < _LEAST_LIFE:
            return None
        return float(np.polyfit(times[kept], values[kept], 1)[0]) * 3600.0


class StackSoak:
    """One run."""

    def __init__(self, session: Session, length: float, kill_every: float, seed: int) -> None:
        """Of `length` [s] simulated, with a kill every `kill_every` [s]."""
        self._session, self._length, self._kill_every = session, length, kill_every
        self._random = Random(seed)
        self.lives: list[Life] = []
        self._alive: dict[str, tuple[Life, float]] = {}
        self.kills = 0
        node = session.node
        self._schedules = node.create_publisher(
            ContactScheduleMessage, "constraints/contact_schedule", SCHEDULE_QOS
        )
        self._sensor = node.create_publisher(
            ObstacleStateArray, "constraints/obstacles", SENSOR_PUBLISHER_QOS
        )

    @property
    def now_ns(self) -> int:
        """Simulated time [ns]."""
        state = self._session.state
        return 0 if state is None else nanoseconds_from_time(state.header.stamp)

    def start(self, name: str, **parameters: object) -> None:
        """Start a node, and follow its memory from now on."""
        self._session.start(name, "", **parameters)
        life = Life(name)
        self.lives.append(life)
        self._alive[name] = (life, self.now_ns / NANOSECONDS)

    def pause(self, paused: bool) -> None:
        """Let time run, or stop it."""
        client = self._session.node.create_client(SetBool, "sim_bridge/pause")
        self._session.until(client.service_is_ready, "the bridge")
        future = client.call_async(SetBool.Request(data=paused))
        self._session.until(future.done, "the answer of the bridge")

    def run(self, wall_limit: float) -> None:
        """Drive until the end, at most `wall_limit` [s] of wall time.

        Raises:
            GhcError: time stands still, or a node ended by itself.
        """
        end = time.monotonic() + wall_limit
        acted = sampled = 0.0
        killed, heard, told = 0.0, time.monotonic(), 0.0
        last = -1
        while (now := self.now_ns / NANOSECONDS) < self._length and time.monotonic() < end:
            self._session.spin(0.02)
            if self.now_ns != last:
                last, heard = self.now_ns, time.monotonic()
            elif time.monotonic() - heard > _PATIENCE:
                raise ghc.GhcError(f"simulated time stands still at {now:g} s")
            if now - acted >= _ACT:
                acted = now
                self._act()
            if now - sampled >= _SAMPLE:
                sampled = now
                self._sample(now)
            if now - killed >= self._kill_every:
                killed = now
                self._kill()
            if now - told >= 60.0:
                told = now
                print(f"soak: {now:.0f} of {self._length:g} s simulated", file=sys.stderr)

    def _act(self) -> None:
        random, session, now_ns = self._random, self._session, self.now_ns
        order = random.choice(ORDERS)
        session.ask_with_id(f"soak_{now_ns}", order)
        target = (0.5 + random.uniform(-0.1, 0.1), random.uniform(-0.3, 0.3), 0.6)
        session.refer(target, random.choice(("end_effector", "elbow")))
        times = (now_ns / NANOSECONDS + 0.3 + 0.4 * np.arange(4)).tolist()
        lower = [random.uniform(0.0, 10.0) for _ in times]
        upper = [random.uniform(20.0, 60.0) for _ in times]
        contact = f"contact_{random.randrange(4)}"
        schedule = ContactSchedule.checked(contact, times, lower, upper)
        self._schedules.publish(schedule_message(schedule))
        reading = ObstacleStateArray()
        reading.header.stamp = time_from_nanoseconds(now_ns)
        for i in range(random.randrange(5)):
            position = [2.0 + random.uniform(0.0, 0.5), random.uniform(-0.1, 0.1), 0.5]
            measured = Measurement.checked(
                f"obstacle_{i}", "tool", position, [-1.0, 0.0, 0.0], 1.5, 0.4
            )
            reading.obstacles.append(measurement_message(measured))
        self._sensor.publish(reading)

    def _sample(self, now: float) -> None:
        for name, process in self._session.processes.items():
            if process.exit_code is not None:
                raise ghc.GhcError(f"{name} ended with {process.exit_code}")
            if name in self._alive:
                life, since = self._alive[name]
                life.times.append(round(now - since, 3))
                life.resident.append(round(resident_memory(process.pid), 4))

    def _kill(self) -> None:
        name = KILLED[self.kills % len(KILLED)]
        self.kills += 1
        self._session.kill(name)
        self.start(name, **PARAMETERS.get(name, {}))


PARAMETERS: dict[str, Mapping[str, object]] = {"controller": {"lockstep": "true"}}


def soak_stack(
    folder: Path, length: float, warm_up: float, kill_every: float, wall_limit: float = math.inf
) -> dict[str, Any]:
    """Run and judge; figures. After `wall_limit` [s] of wall time what was reached is judged.

    Raises:
        GhcError: a node ended by itself, or simulated time stood still.
    """
    begun = time.monotonic()
    bag = folder / "recording"
    with Session(folder, CONTROL_DT) as session:
        soak = StackSoak(session, length, kill_every, seed=0)
        soak.start("recorder", output=bag, record_mode="full")
        for name in KILLED:
            soak.start(name, **PARAMETERS.get(name, {}))
        soak.start(
            "sim_bridge", mode="lockstep", lossless="true", lockstep_timeout=60.0,
            stop_time=length, paused="true",
        )  # fmt: skip
        # It is repeated until everybody has it.
        session.until(lambda: session.state is not None, "the first state")
        session.until(lambda: session.command is not None, "its answer")
        session.until(lambda: _has_states(bag), "the first state in the recording")
        soak.pause(False)
        soak.run(wall_limit)
        if soak.now_ns < round(length * NANOSECONDS):
            soak.pause(True)
        session.spin(1.0)
        length = soak.now_ns / NANOSECONDS
        code = session.stop("recorder")
    recorded = {
        nanoseconds_from_time(message.header.stamp)
        for topic, _, message in read_messages(bag, "sensor_msgs/msg/JointState")
        if topic.endswith("joint_states")
    }
    period_ns = round(CONTROL_DT * NANOSECONDS)
    expected = set(range(0, round(length * NANOSECONDS) + 1, period_ns))
    rows = [
        {
            "node": life.node,
            "lived_s": life.times[-1] if life.times else 0.0,
            "first_mb": life.resident[0] if life.resident else 0.0,
            "last_mb": life.resident[-1] if life.resident else 0.0,
            "growth_mb_per_hour": growth,
            "met": growth is None or growth <= GROWTH_GOAL,
        }
        for life in soak.lives
        for growth in [life.growth(warm_up)]
    ]
    missing = len(expected - recorded)
    return {
        "simulated_s": length, "wall_s": round(time.monotonic() - begun, 1),
        "warm_up_s": warm_up, "kills": soak.kills, "recorder_exit": code,
        "ticks": len(expected), "ticks_missing": missing, "lives": rows,
        "holds": missing == 0 and code == 0 and all(row["met"] for row in rows),
    }  # fmt: skip


def _has_states(bag: Path) -> bool:
    """Whether a recording that is being written has joint states."""
    if not any(bag.glob("*.mcap")):
        return False
    return any(m is not None and t.name == "/joint_states" for t, m in raw_messages(bag))


def run_stack(options: argparse.Namespace) -> bool:
    """Soak the stack, print and write stack.json; whether all holds."""
    length = QUICK_LENGTH if options.quick else 3600.0 * options.hours
    warm_up, kill_every = (2.0, 4.0) if options.quick else (options.warm_up, 2 * options.warm_up)
    shutil.rmtree(options.output / "stack", ignore_errors=True)
    figures = soak_stack(
        options.output / "stack", length, warm_up, kill_every, 60.0 * options.wall_minutes
    )
    path = options.output / "stack.json"
    path.write_text(json_text(figures, 1) + "\n", encoding="utf-8")
    for row in figures["lives"]:
        growth = row["growth_mb_per_hour"]
        told = "too short a life" if growth is None else f"{growth:.2f} MB/h"
        print(f"{row['node']:22} {row['lived_s']:8.0f} s  {row['last_mb']:7.1f} MB  {told}")
    print(f"states missing in the recording: {figures['ticks_missing']} of {figures['ticks']}")
    if not options.quick and options.write_docs:
        write_stack_section(figures, ROOT / "docs" / "reliability.md")
    return bool(figures["holds"])
