"""Whole nodes over DDS: mutated bytes on every topic that they read, in waves.

After each wave every node has to run and the robot to be driven; at the end each node may have
grown by no more than MEMORY_GOAL since the first wave, recorder and viewer have to end in order,
and the recording has to open.
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

from ghc_msgs.msg import (
    ConstraintPreview,
    ConstraintPreviews,
    ContactSchedule,
    ControllerState,
    Epoch,
    ObstacleState,
    ObstacleStateArray,
    PlannedMotion,
    PriorityTransition,
    TaskReference,
    TaskReferencePoint,
    TaskState,
    Tick,
)
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from benchmarks.faults.session import JOINTS, SCENE, Session
from benchmarks.soak.memory import resident_memory
from ghc_controller.ros.qos import (
    CLOCK_QOS,
    CONTROL_PUBLISHER_QOS,
    LATCHED_QOS,
    RELIABLE_QOS,
    SCHEDULE_QOS,
    STREAM_QOS,
)
from ghc_sim_bridge.recorder.bag_reading import raw_messages

WAVE = 200  # [-] messages
PAUSE = 1e-3  # [s] wall between two of them
MEMORY_GOAL = 16.0  # [MB] per node
NODES = ("sim_bridge", "controller", "obstacle_bounds", "contact_force_bounds")
WATCHERS = ("recorder", "viewer")


def originals() -> dict[str, tuple[Any, Any]]:
    """Topic -> quality of service, and a sound message."""
    states = JointState(name=JOINTS, position=[0.1] * 7, velocity=[0.0] * 7, effort=[1.0] * 7)
    obstacle = ObstacleState(id="wall", protected_frame="tool", distance=0.4, safe_distance=0.1)
    obstacle.normal[:] = [-1.0, 0.0, 0.0]
    schedule = ContactSchedule(contact="left", times=[0.0, 1.0], lower=[0.0] * 2, upper=[9.0] * 2)
    bounds = ConstraintPreview(kind="contact_forces", step=0.01, points=2, rows=["left"])
    bounds.lower, bounds.upper, bounds.active = [0.0] * 2, [9.0] * 2, [True]
    bounds.conflict, bounds.status = [False], [0]
    motion = PlannedMotion(id="wall", protected_frame="tool", safe_distance=0.1, jerk=[0.0] * 3)
    motion.normal[:] = [-1.0, 0.0, 0.0]
    moving = ConstraintPreview(kind="obstacle_motion", step=0.01, points=2, motions=[motion])
    previews = ConstraintPreviews(previews=[bounds, moving])
    point = TaskReferencePoint(position=[0.5, 0.1, 0.7])
    shown = TaskState(name="end_effector", error=[0.1] * 3, reference=[0.4, 0.0, 0.5])
    report = ControllerState(tasks=[shown], alpha=[0.0])
    order = "elbow > end_effector > posture"
    return {
        "joint_states": (CONTROL_PUBLISHER_QOS, states),
        "joint_commands": (CONTROL_PUBLISHER_QOS, states),
        "sim_bridge/epoch": (LATCHED_QOS, Epoch()),
        "ghc/tick": (CONTROL_PUBLISHER_QOS, Tick()),
        "ghc/priority_transition": (RELIABLE_QOS, PriorityTransition(hierarchy=order)),
        "ghc/task_reference": (RELIABLE_QOS, TaskReference(task="elbow", points=[point])),
        "ghc/controller_state": (STREAM_QOS, report),
        "/clock": (CLOCK_QOS, Clock()),
        "constraints/obstacles": (
            CONTROL_PUBLISHER_QOS,
            ObstacleStateArray(obstacles=[obstacle]),
        ),
        "constraints/contact_schedule": (SCHEDULE_QOS, schedule),
        "constraints/preview": (CONTROL_PUBLISHER_QOS, previews),
    }


def mutant(data: bytes, random: Random) -> bytes:
    """Some bytes changed, cut off, doubled or put in."""
    changed = bytearray(data)
    for _ in range(random.randint(0, 4)):
        at, how = random.randrange(len(changed) + 1), random.randrange(4)
        if how == 0:
            del changed[at:]
        elif how == 1:
            changed[at : at + 1] = random.randbytes(1)
        elif how == 2:
            changed[at : at + 8] = random.choice([random.randbytes(8), b"\xff" * 8, b"\0" * 8])
        else:
            changed[at:at] = changed[at : at + random.randrange(64)]
    return bytes(changed)


def _drives_on(session: Session, answered: int) -> bool:
    """Whether the robot is driven, 20 answers after the first `answered`."""
    return session.answered > answered + 20 and session.driving()


def fuzz_nodes(cases: int, seed: int, folder: Path) -> dict[str, Any]:
    """Run; figures, `holds` among them."""
    random = Random(seed)
    with Session(folder) as session:
        bag = folder / "recording"
        session.start("recorder", output=bag, record_mode="full")
        session.start("viewer", scene=SCENE, output=folder / "live.rrd")
        for name in NODES:
            session.start(name)
        session.ready()
        kinds = originals()
        publishers = {
            topic: session.node.create_publisher(type(message), topic, qos)
            for topic, (qos, message) in kinds.items()
        }
        sound = {topic: bytes(serialize_message(m)) for topic, (_, m) in kinds.items()}
        # The middleware sends no more bytes than a message of fixed size has.
        fixed = {
            t: len(sound[t]) for t, (_, m) in kinds.items() if isinstance(m, Epoch | Tick | Clock)
        }
        topics = sorted(kinds)
        sent, slowest, before = 0, 0.0, dict[str, float]()
        failure = ""
        while sent < cases and not failure:
            for _ in range(WAVE):
                topic = random.choice(topics)
                data = mutant(sound[topic], random)
                publishers[topic].publish(data[: fixed.get(topic, len(data))])
                session.spin(PAUSE)
            sent += WAVE
            dead = {
                n: p.exit_code for n, p in session.processes.items() if p.exit_code is not None
            }
            if dead:
                failure = f"ended: {dead}"
                break
            try:
                taken = session.until(
                    partial(_drives_on, session, session.answered),
                    "a robot that is driven",
                    20.0,
                )
            except AssertionError as error:
                failure = f"{error}; mode {session.mode.mode}: {session.mode.reason}"
                break
            slowest = max(slowest, taken)
            if not before:
                before = {n: resident_memory(p.pid) for n, p in session.processes.items()}
            if sent % (10 * WAVE) == 0:
                print(f"fuzz: nodes, {sent} of {cases}", file=sys.stderr, flush=True)
        growth = {
            n: round(resident_memory(p.pid) - before.get(n, 0.0), 2)
            for n, p in session.processes.items()
            if p.exit_code is None and before
        }
        rejected = session.refused()
        ends = {name: session.stop(name) for name in WATCHERS if name in session.processes}
        recorded = sum(message is not None for _, message in raw_messages(bag))
        return {
            "cases": sent,
            "rejected": rejected,
            "recorded": recorded,
            "exit_codes": ends,
            "slowest_recovery_s": round(slowest, 3),
            "growth_mb": growth,
            "failure": failure,
            "holds": not failure
            and all(v <= MEMORY_GOAL for v in growth.values())
            and not any(ends.values())
            and recorded > sent,
        }
