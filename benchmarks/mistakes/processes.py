"""Mistakes at the command line: programs started as processes, and what they print."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks.mistakes.mistake import Mistake
from ghc_sim_bridge.run.domain import DomainLock

_ROOT = Path(__file__).resolve().parents[2]
_RUN = (sys.executable, str(_ROOT / "tools" / "ros2_run.py"))
_CONTROLLER = ("ghc_controller", "controller")
_BRIDGE = ("ghc_sim_bridge", "sim_bridge", "--ros-args", "-p", "scene:=kuka_lwr")
_ROBOT = ("--ros-args", "-p", "robot:=kuka_lwr")
_DEADLINE = 120.0  # [s] wall
_STARTED = (b": ready", b", running")  # in the log of a controller, of a bridge


def printed(
    *command: str, beside: Sequence[tuple[str, ...]] = (), env: dict[str, str] | None = None
) -> Callable[[Path], str]:
    """What a program prints until it ends; `beside` are started first and run meanwhile."""

    def do(folder: Path) -> str:
        lock = DomainLock()
        environment = os.environ | {
            "ROS_DOMAIN_ID": str(lock.id),
            "ROS_LOG_DIR": str(folder),
            **(env or {}),
        }
        others = []
        try:
            for index, other in enumerate(beside):
                log = folder / f"beside_{index}.log"
                with log.open("wb") as file:
                    others.append(
                        subprocess.Popen(
                            [*_RUN, *other],
                            stdout=file,
                            stderr=subprocess.STDOUT,
                            env=environment,
                            cwd=folder,
                        )
                    )
                _wait_for(_STARTED, log)
            run = subprocess.run(
                [*_RUN, *command],
                capture_output=True,
                text=True,
                env=environment,
                cwd=folder,
                timeout=_DEADLINE,
                check=False,
            )
            if not run.returncode:
                raise AssertionError(f"{command} ended with 0:\n{run.stdout}{run.stderr}")
            return run.stdout + run.stderr
        finally:
            for process in others:
                process.terminate()
            for process in others:
                process.wait(_DEADLINE)
            lock.release()

    return do


def _wait_for(words: Sequence[bytes], log: Path) -> None:
    """Until a log contains one of the words."""
    deadline = time.monotonic() + _DEADLINE
    while not any(word in log.read_bytes() for word in words):
        if time.monotonic() > deadline:
            raise TimeoutError(f"{log} has none of {words} after {_DEADLINE:g} s")
        time.sleep(0.05)


PROCESSES = (
    Mistake(
        35,
        "`-p stiffness:=3.0`",
        ("controller: ", "unknown parameter 'stiffness'; known: ", "robot", "hierarchy"),
        printed(*_CONTROLLER, *_ROBOT, "-p", "stiffness:=3.0"),
        True,
    ),
    Mistake(
        36,
        "executable `controler`",
        ("no executable 'controler' in 'ghc_controller'; it has: ", "controller"),
        printed("ghc_controller", "controler"),
        True,
    ),
    Mistake(
        37,
        "`controller` without the parameter `robot`",
        ("controller: ", "parameter 'robot'", "given", "needed"),
        printed(*_CONTROLLER),
        True,
    ),
    Mistake(
        38,
        "`RMW_IMPLEMENTATION=rmw_cyclonedds_cpp` where it is not installed",
        ("RMW_IMPLEMENTATION", "'rmw_cyclonedds_cpp' given", "installed: ", "rmw_fastrtps_cpp"),
        printed(*_CONTROLLER, *_ROBOT, env={"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"}),
        True,
    ),
    Mistake(
        39,
        "the bridge in lockstep without a controller (here for 1 s)",
        ("sim_bridge: ", "no command on", "within 1.0 s", "is the controller running"),
        printed(*_BRIDGE, "-p", "lockstep_timeout:=1.0"),
        True,
    ),
    Mistake(
        40,
        "a transition in a namespace without a controller, while one runs in `/left`",
        ("transition: ", "no ghc/priority_matrix in '/right'", "known: /left", "-r __ns:="),
        printed(
            "ghc_controller",
            "transition",
            "elbow > posture",
            "--timeout",
            "5",
            "--ros-args",
            "-r",
            "__ns:=/right",
            beside=((*_CONTROLLER, *_ROBOT, "-r", "__ns:=/left"),),
        ),
        True,
    ),
    Mistake(
        41,
        "two bridges in one domain",
        ("sim_bridge: ", "joint_states", "published already", "one bridge", "namespace or domain"),
        printed(*_BRIDGE, beside=((*_BRIDGE, "-p", "mode:=realtime"),)),
        True,
    ),
)
