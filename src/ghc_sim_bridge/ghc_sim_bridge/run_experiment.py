"""One run: nodes as processes, scripted messages, the wait for the end, and what came of it."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import rclpy
import yaml
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

from ghc_controller.errors import GhcError
from ghc_controller.robots import find_robot
from ghc_sim_bridge.controller_trace import ControllerTrace
from ghc_sim_bridge.experiment_client_node import (
    REFERENCE_TOPIC,
    STATE_TOPIC,
    TRANSITION_TOPIC,
    ExperimentClient,
    ScriptedTransition,
)
from ghc_sim_bridge.processes import NodeProcesses
from ghc_sim_bridge.progress import Progress
from ghc_sim_bridge.robot_changes import write_changed_robot
from ghc_sim_bridge.ros_domain import DomainLock
from ghc_sim_bridge.run_plan import RunPlan

_EXECUTABLES = {
    "sim_bridge": ("ghc_sim_bridge", "sim_bridge"),
    "controller": ("ghc_controller", "controller"),
    "recorder": ("ghc_sim_bridge", "recorder"),
    "viewer": ("ghc_sim_bridge", "viewer"),
}
_SCRIPT = (REFERENCE_TOPIC, TRANSITION_TOPIC)
_READ_BEFORE_START = {
    "controller": _SCRIPT,
    "recorder": (*_SCRIPT, STATE_TOPIC),
    "viewer": (STATE_TOPIC,),
}
_MAY_END = ("viewer",)  # whoever watches may close the window
_START_DEADLINE = 180.0  # [s] wall; the first start compiles the controller's kernels
_PATIENCE = 5.0  # [s] wall of waiting for a node before it is said
_CONTROLLER_START = "a priority matrix from controller (it compiles its kernels once)"
_ANSWER_DEADLINE = 10.0  # [s] wall
_REPEAT_PERIOD = 1.0  # [s] wall between two copies of an unanswered transition
_STALL_DEADLINE = 30.0  # [s] wall without a word from the controller
_NEAR_END = 0.5  # [s] simulated


@dataclass(frozen=True, slots=True)
class RunOutcome:
    """What a run left, besides the files of its folder."""

    exit_codes: Mapping[str, int | None]
    wall_seconds: float  # from the release of time to the last state
    trace: ControllerTrace
    robot: Path  # robot file that the controller read
    log: Path  # the bridge's full-rate log


def run_experiment(plan: RunPlan) -> RunOutcome:
    """Run one plan over DDS; everything that is written goes to plan.folder.

    Raises GhcError (a node died, a transition was rejected, something did not come in time).
    """
    robot = _prepare_folder(plan)
    domain = DomainLock()
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ["ROS_LOG_DIR"] = str(plan.folder / "logs")
    environment = os.environ | {"ROS_DOMAIN_ID": str(domain.id)}
    try:
        with NodeProcesses(plan.folder / "logs", environment) as nodes:
            for name in plan.parameters:
                arguments = ["--ros-args", "--params-file", str(plan.folder / "parameters.yaml")]
                nodes.start(name, *_EXECUTABLES[name], arguments)
            wall_seconds, trace = _drive(plan, nodes, domain.id)
            nodes.stop()
            exit_codes = nodes.exit_codes()
    finally:
        domain.release()
    return RunOutcome(exit_codes, wall_seconds, trace, robot, plan.folder / "log.npz")


def _prepare_folder(plan: RunPlan) -> Path:
    """Make an empty folder with the parameters of all nodes; the robot file to be used."""
    if plan.folder.exists():
        shutil.rmtree(plan.folder)
    (plan.folder / "logs").mkdir(parents=True)
    parameters: dict[str, dict[str, Any]] = {
        node: dict(values) for node, values in plan.parameters.items()
    }
    robot = find_robot(str(parameters["controller"]["robot"]))
    if plan.changes:
        robot = write_changed_robot(robot, plan.changes, plan.folder / "robot.yaml")
        for values in parameters.values():
            if "robot" in values:
                values["robot"] = str(robot)
    content = {node: {"ros__parameters": values} for node, values in parameters.items()}
    text = yaml.safe_dump(content, sort_keys=False)
    (plan.folder / "parameters.yaml").write_text(text, encoding="utf-8")
    return robot


def _drive(plan: RunPlan, nodes: NodeProcesses, domain: int) -> tuple[float, ControllerTrace]:
    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    client = ExperimentClient(context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(client)
    try:
        driver = _Driver(plan, nodes, client, executor)
        driver.wait_for_nodes()
        driver.send_script()
        return driver.run(), client.trace
    finally:
        executor.shutdown()
        client.destroy_node()
        rclpy.shutdown(context=context)


class _Driver:
    """The steps of a run, each with a deadline and an eye on the processes."""

    def __init__(
        self,
        plan: RunPlan,
        nodes: NodeProcesses,
        client: ExperimentClient,
        executor: SingleThreadedExecutor,
    ) -> None:
        self._plan = plan
        self._nodes = nodes
        self._client = client
        self._executor = executor

    def wait_for_nodes(self) -> None:
        """Until each node has said something."""
        client = self._client
        client.watch_states(True)
        self._until(
            lambda: client.state_time is not None, "a joint state from sim_bridge", _START_DEADLINE
        )
        client.watch_states(False)
        self._until(lambda: client.controller_spoke, _CONTROLLER_START, _START_DEADLINE)
        client.stop_waiting_for_controller()
        for name in self._plan.parameters:
            for topic in _READ_BEFORE_START.get(name, ()):
                self._until(
                    partial(client.is_read_by, name, topic),
                    f"the subscription of {name} to {topic}",
                    _START_DEADLINE,
                )
        self._until(
            lambda: client.pause_service_ready, "the bridge's pause service", _ANSWER_DEADLINE
        )

    def send_script(self) -> None:
        """References and transitions, before time runs; each transition until it is answered."""
        client, plan = self._client, self._plan
        for reference in plan.scenario.references:
            client.publish_reference(reference, plan.duration)
        for transition in scripted_transitions(plan):
            self._send_until_accepted(transition)

    def run(self) -> float:
        """Let time run to the end; the wall time that it took [s]."""
        client, plan = self._client, self._plan
        answer = client.resume()
        self._until(answer.done, "the answer of sim_bridge/pause", _ANSWER_DEADLINE)
        if not answer.result().success:
            raise GhcError(f"sim_bridge/pause refused: {answer.result().message}")
        began = time.monotonic()
        title = f"{plan.scenario.name} ({plan.folder.name})"
        with Progress(title, plan.duration) as progress:
            heard, heard_at = 0, began
            while not self._at_end():
                self._turn()
                if len(client.trace.time) != heard:
                    heard, heard_at = len(client.trace.time), time.monotonic()
                    progress.update(client.trace.time[-1], self._hierarchy())
                    near_end = client.trace.time[-1] > plan.duration - _NEAR_END
                    client.watch_states(near_end)
                if time.monotonic() - heard_at > _STALL_DEADLINE:
                    at = client.trace.time[-1] if client.trace.time else 0.0
                    raise GhcError(
                        f"no controller_state for {_STALL_DEADLINE:g} s after "
                        f"t = {at:g} s of {plan.duration:g} s"
                    )
        return time.monotonic() - began

    def _at_end(self) -> bool:
        state_time = self._client.state_time
        return state_time is not None and state_time > self._plan.duration - 1e-9

    def _hierarchy(self) -> str:
        now = self._client.trace.time[-1]
        for planned in reversed(self._plan.phases):
            if now >= planned.start:
                return planned.phase.hierarchy
        return self._plan.phases[0].phase.hierarchy

    def _send_until_accepted(self, transition: ScriptedTransition) -> None:
        client = self._client
        deadline = time.monotonic() + _ANSWER_DEADLINE
        sent_at = -_REPEAT_PERIOD
        while transition.id not in client.accepted:
            if time.monotonic() - sent_at >= _REPEAT_PERIOD:
                client.publish_transition(transition)
                sent_at = time.monotonic()
            self._turn()
            client.raise_if_rejected()
            if time.monotonic() > deadline:
                raise GhcError(
                    f"the controller did not answer transition '{transition.id}' "
                    f"within {_ANSWER_DEADLINE:g} s"
                )

    def _until(self, condition: Callable[[], bool], what: str, seconds: float) -> None:
        began, told = time.monotonic(), False
        while not condition():
            self._turn()
            waited = time.monotonic() - began
            if waited > seconds:
                raise GhcError(f"{what} did not come within {seconds:g} s")
            if waited > _PATIENCE and not told:
                print(f"waiting for {what} ...", file=sys.stderr, flush=True)
                told = True

    def _turn(self) -> None:
        self._executor.spin_once(timeout_sec=0.02)
        self._nodes.check(may_end=_MAY_END)


def scripted_transitions(plan: RunPlan) -> tuple[ScriptedTransition, ...]:
    """The transitions of a plan; a hierarchy string at the start is a parameter instead."""
    return tuple(
        ScriptedTransition(
            id=f"phase_{index}",
            start=planned.start,
            duration=planned.ramp,
            hierarchy=planned.phase.hierarchy if planned.phase.table is None else "",
            table=planned.phase.table,
        )
        for index, planned in enumerate(plan.phases)
        if index > 0 or planned.phase.table is not None
    )
