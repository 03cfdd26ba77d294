"""Parameters of the nodes of this package."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.ros.process.scheduling import Scheduling
from ghc_controller.safety.torque_gate import DEFAULT_TORQUE_RATE
from ghc_controller.schema.declared import inline
from ghc_controller.schema.domains import Distinct, Range
from ghc_controller.schema.parameters import (
    EXECUTOR,
    given,
    not_negative,
    one_of,
    parameter,
    positive,
    rate,
)
from ghc_controller.types import CONTROL_DT
from ghc_sim_bridge.simulation.timing import PHYSICS_DT


@dataclass(frozen=True, slots=True)
class BridgeParameters:
    """Parameters of sim_bridge."""

    scene: str = parameter("", "name of a scene, or path of its YAML file", given)
    mode: str = parameter("lockstep", "lockstep or realtime", one_of("lockstep", "realtime"))
    control_dt: float = parameter(CONTROL_DT, "[s] control period", positive)
    physics_dt: float = parameter(PHYSICS_DT, "[s] physics step; divides control_dt", positive)
    stop_time: float = parameter(0.0, "[s] simulated end of the run; 0 = never", not_negative)
    paused: bool = parameter(False, "start paused; ~/pause starts the run")
    log_file: str = parameter("", "full-rate log (.npz) written at the end; empty = none")
    torque_rate_limit: float = parameter(
        DEFAULT_TORQUE_RATE,
        "[Nm/s] of the gate, also at transitions to and from hold; 0 = off",
        not_negative,
    )
    watchdog_timeout: float = parameter(
        0.02, "[s] realtime: a robot without a command this fresh is held", positive
    )
    lockstep_timeout: float = parameter(
        10.0, "[s] wall: lockstep ends with an error when a state is not answered", positive
    )
    executor: str = EXECUTOR
    scheduling: Scheduling = inline(Scheduling)
    publish_contacts: bool = parameter(True, "publish contacts/<name>")
    lossless: bool = parameter(
        False, "publish so that a reliable reader gets every message: slow readers slow the run"
    )
    disturbance_seed: int = parameter(
        -1, "draws the disturbances below, in the simulator only; -1 = none"
    )
    disturbance_mass: float = parameter(
        0.05, "[-] each link's mass by a factor of 1 -+ this", not_negative
    )
    disturbance_friction_lower: float = parameter(
        0.6, "[-] friction of all contacts, drawn between; 0 = the scene's", not_negative
    )
    disturbance_friction_upper: float = parameter(1.0, "[-]", not_negative)
    disturbance_push: float = parameter(20.0, "[N] horizontal push, any direction", not_negative)
    disturbance_push_frame: str = parameter("", "frame that is pushed; empty = no push")
    disturbance_push_duration: float = parameter(0.1, "[s]", not_negative)
    disturbance_push_from: float = parameter(0.0, "[s] the push begins after", not_negative)
    disturbance_push_until: float = parameter(0.0, "[s] the push begins before", not_negative)
    disturbance_velocity_noise: float = parameter(
        0.001, "[rad/s] standard deviation on published joint velocities", not_negative
    )


@dataclass(frozen=True, slots=True)
class RecorderParameters:
    """Parameters of recorder."""

    output: str = parameter("", "rosbag2 folder to be written (MCAP and metadata.yaml)", given)
    record_mode: str = parameter(
        "decimated",
        "decimated (fast topics at fast_rate) or full (every message)",
        one_of("decimated", "full"),
    )
    fast_rate: float = parameter(100.0, "[Hz] of simulated time, for fast topics", rate)
    executor: str = EXECUTOR


@dataclass(frozen=True, slots=True)
class ReplayParameters:
    """Parameters of replay."""

    recording: str = parameter("", "rosbag2 folder or .mcap file, also a truncated one", given)
    rate: float = parameter(
        1.0, "[-] times as fast as recorded", Range(minimum=0.001, maximum=1000.0)
    )
    loop: bool = parameter(False, "begin again at the end; stamps then begin again as well")
    start: float = parameter(0.0, "[s] of the recording to skip", not_negative)
    topics: tuple[str, ...] = parameter((), "names of topics; none = all", Distinct())
    delay: float = parameter(
        1.0, "[s] wall before the first message, for readers to find the topics", not_negative
    )
    executor: str = EXECUTOR


@dataclass(frozen=True, slots=True)
class ViewerParameters:
    """Parameters of viewer."""

    scene: str = parameter("", "name of a scene, or path of its YAML file", given)
    robot: str = parameter("", "robot of the controller (name or path); empty = as in the scene")
    display: str = parameter(
        "auto",
        "window, browser (a page served on this machine), or auto (window if there is a screen)",
        one_of("auto", "window", "browser"),
    )
    output: str = parameter("", "write the view to this .rrd file instead of showing it")
    executor: str = EXECUTOR
