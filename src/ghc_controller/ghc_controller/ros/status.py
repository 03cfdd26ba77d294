"""Status of the controller node: steps, priorities, health.

Publishes ghc/controller_state, ghc/priority_matrix (latched), /diagnostics.
"""

from __future__ import annotations

from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import ControllerState, PriorityMatrix
from rclpy.node import Node

from ghc_controller.controller import Controller
from ghc_controller.report.report import StepStatus
from ghc_controller.ros.conversions.common import diagnostics_message
from ghc_controller.ros.conversions.previews import obstacle_message
from ghc_controller.ros.conversions.status import controller_state_message, matrix_message
from ghc_controller.ros.qos import LATCHED_QOS, STREAM_QOS
from ghc_controller.ros.rejections import Recent, Rejections
from ghc_controller.types import NANOSECONDS


class StatusPublisher:
    """Publishes the status of the controller at `state_rate` and at every fallback."""

    def __init__(
        self, node: Node, controller: Controller, rejections: Rejections, state_rate: float
    ) -> None:
        """`state_rate` [Hz] of the robot's time."""
        self._name = node.get_name()
        self._controller = controller
        self._rejections = rejections
        self._recent = Recent()
        self._period_ns = round(NANOSECONDS / state_rate)
        self._due_ns = 0
        self._shown_matrix: tuple[bytes, tuple[float, ...], bool, int] | None = None
        self._state = node.create_publisher(ControllerState, "ghc/controller_state", STREAM_QOS)
        self._matrix = node.create_publisher(PriorityMatrix, "ghc/priority_matrix", LATCHED_QOS)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)

    def reset(self) -> None:
        """Time restarts."""
        self._due_ns = 0

    def publish(self, stamp_ns: int, epoch: int, status: StepStatus) -> None:
        """Publish the status of the last step, at `stamp_ns` [ns], if due."""
        if stamp_ns < self._due_ns and status is not StepStatus.FALLBACK:
            return
        self._due_ns = stamp_ns - stamp_ns % self._period_ns + self._period_ns
        if self._state.get_subscription_count():
            self._publish_state(epoch)
        priorities = self._controller.priorities
        shares = tuple(candidate.share for candidate in priorities.in_force.candidates)
        shown = (priorities.alpha.tobytes(), shares, priorities.in_transition, epoch)
        if shown != self._shown_matrix:  # latched: late subscribers receive the last one
            self._shown_matrix = shown
            self._matrix.publish(matrix_message(priorities, stamp_ns / NANOSECONDS))

    def _publish_state(self, epoch: int) -> None:
        controller = self._controller
        report = controller.report()
        rejected = dict(self._rejections.counts)  # the request thread also writes to it
        report.counts.update({f"rejected_{k}": n for k, n in rejected.items()})
        message = controller_state_message(
            report,
            controller.priorities,
            epoch,
            controller.formulation.name,
            controller.formulation.solver.name,
            controller.model.joint_names,
        )
        message.obstacles = [obstacle_message(entry) for entry in report.obstacles]
        self._state.publish(message)

    def publish_diagnostics(self, now: float | None, lasting: str, mode: str) -> None:
        """Publish counters; those that rose lately are a warning.

        Args:
            now: [s] of the last state, None before the first.
            lasting: what is a warning as long as it lasts: generators that have timed out, a
                latched fault.
            mode: the current mode, and why.
        """
        controller = self._controller
        counts = controller.counts | controller.gate.counts
        refused = sum(self._rejections.counts.values())
        rejected = {f"rejected_{k}": n for k, n in sorted(self._rejections.counts.items())}
        trouble = counts["fallback_ticks"] + refused
        warning, summary = self._recent.told(
            trouble,
            f"{counts['fallback_ticks']} ticks without a solution, {refused} inputs rejected",
            "ok" if now is not None else "waiting for joint_states",
        )
        summary = "; ".join(part for part in (lasting, summary) if part)
        values: dict[str, object] = {"formulation": controller.formulation.name, "mode": mode}
        self._diagnostics.publish(
            diagnostics_message(
                round((now or 0.0) * NANOSECONDS),
                self._name,
                summary,
                warning or bool(lasting),
                values | counts | rejected,
            )
        )
