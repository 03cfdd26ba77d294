"""The steps of a run, as a client of its nodes: wait for them, send the script, let time run."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import partial

from rclpy.executors import SingleThreadedExecutor

from ghc_controller.errors import GhcError
from ghc_controller.ros.stop_signals import raise_if_stopped
from ghc_mpc_constraints.generator import GENERATORS
from ghc_sim_bridge.ros.experiment_client import ExperimentClient, ScriptedTransition
from ghc_sim_bridge.ros.experiment_nodes import MAY_END, read_before_start
from ghc_sim_bridge.run.processes import NodeProcesses
from ghc_sim_bridge.run.progress import Progress
from ghc_sim_bridge.scenario.plan import RunPlan

_START_DEADLINE = 180.0  # [s] wall
_PATIENCE = 5.0  # [s] wall of waiting for a node before a message
_CONTROLLER_START = "a priority matrix from controller"
_ANSWER_DEADLINE = 10.0  # [s] wall
_REPEAT_PERIOD = 1.0  # [s] wall between two copies of an unanswered transition
_STALL_DEADLINE = 30.0  # [s] wall without a message from the controller
_NEAR_END = 0.5  # [s] simulated


class ExperimentDriver:
    """The steps of a run, each with a deadline and a check of the processes."""

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
        """Wait until each node has sent a message."""
        client = self._client
        client.watch_states(True)
        self._until(
            lambda: client.state_time is not None, "a joint state from sim_bridge", _START_DEADLINE
        )
        client.watch_states(False)
        self._until(lambda: client.controller_spoke, _CONTROLLER_START, _START_DEADLINE)
        client.stop_waiting_for_controller()
        for name in self._plan.parameters:
            for topic in read_before_start(name):
                self._until(
                    partial(client.is_read_by, name, topic),
                    f"the subscription of {name} to {topic}",
                    _START_DEADLINE,
                )
        self._until(
            lambda: client.pause_service_ready, "the bridge's pause service", _ANSWER_DEADLINE
        )

    def send_script(self) -> None:
        """Send all scripted messages before time runs; transitions and schedules until
        accepted."""
        client, plan = self._client, self._plan
        self._send_schedules()
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
            raise GhcError(f"sim_bridge/pause rejected: {answer.result().message}")
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

    def _send_schedules(self) -> None:
        """Send schedules until generators have accepted them and previews show them."""
        for topic, schedules in self._plan.scenario.schedules().items():
            for schedule in schedules:
                self._client.publish_schedule(topic, schedule)
        for generator in self._plan.scenario.generators:
            self._wait_until_judged(generator)

    def _wait_until_judged(self, generator: str) -> None:
        client, topic = self._client, GENERATORS[generator].input.topic
        schedules = self._plan.scenario.schedules().get(topic, ())
        if not schedules:
            return
        self._until(
            lambda: client.schedules_judged(generator, topic) >= len(schedules),
            f"the answer of {generator} to the schedules",
            _ANSWER_DEADLINE,
        )
        if client.schedules_rejected(generator, topic):
            raise GhcError(
                f"{generator} rejected a schedule; the end of its output:\n"
                + self._nodes.last_lines(generator)
            )
        known = {schedule.name for schedule in schedules if schedule.known_from is None}
        self._until(
            lambda: known <= client.planned_rows,
            f"a preview for {', '.join(sorted(known))}",
            _ANSWER_DEADLINE,
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
        raise_if_stopped()
        self._nodes.check(may_end=MAY_END)


def scripted_transitions(plan: RunPlan) -> tuple[ScriptedTransition, ...]:
    """The transitions of a plan; a hierarchy string at the start is a parameter instead."""
    return tuple(
        ScriptedTransition(
            id=f"phase_{index}",
            start=planned.start,
            duration=planned.ramp,
            torque_rate=plan.torque_rate if index > 0 else 0.0,
            hierarchy=planned.phase.hierarchy if planned.phase.table is None else "",
            table=planned.phase.table,
        )
        for index, planned in enumerate(plan.phases)
        if index > 0 or planned.phase.table is not None
    )
