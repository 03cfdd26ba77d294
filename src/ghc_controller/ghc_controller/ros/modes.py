"""Part of the controller node: publishes the mode and serves mode changes.

Publishes  ghc/controller_mode (latched).
Services   ~/arm, ~/hold, ~/reset_fault (std_srvs/Trigger).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ghc_msgs.msg import ControllerMode
from rclpy.node import Node
from std_srvs.srv import Trigger

from ghc_controller.controller import Controller
from ghc_controller.report.report import StepStatus
from ghc_controller.ros.qos import LATCHED_QOS
from ghc_controller.ros.time import time_from_seconds
from ghc_controller.safety.modes import Arming, Mode, ModeLogic

FALLBACK_TIME = 0.1  # [s] without a solution before a fault is raised


class ModeServer:
    """Runs the mode logic: applies it to the controller and publishes it."""

    def __init__(
        self, node: Node, controller: Controller, arming: Arming, changed: Callable[[], None]
    ) -> None:
        """`changed` is called when the current state has to be recomputed."""
        self._node = node
        self._controller = controller
        self._changed = changed
        self._now = 0.0  # [s] of the last state
        self._fallback_since: float | None = None  # [s]
        self.logic = ModeLogic(arming, self._on_change)
        self._publisher = node.create_publisher(ControllerMode, "ghc/controller_mode", LATCHED_QOS)
        self._publish()
        for name in ("arm", "hold", "reset_fault"):
            node.create_service(Trigger, f"~/{name}", partial(self._serve, name))

    @property
    def mode(self) -> Mode:
        """The current mode."""
        return self.logic.mode

    @property
    def text(self) -> str:
        """Mode and reason in a line."""
        return f"{self.logic.mode.name.lower()}: {self.logic.reason}"

    def begin(self, now: float) -> None:
        """A run begins with the state of `now` [s]."""
        self._now = now
        self._fallback_since = None
        self.logic.started()

    def stepped(self, now: float, status: StepStatus) -> None:
        """A state of `now` [s] was answered."""
        self._now = now
        if status is not StepStatus.FALLBACK:
            self._fallback_since = None
            return
        if self._fallback_since is None:
            self._fallback_since = now
        if now - self._fallback_since >= FALLBACK_TIME:
            self.logic.fault(f"no solution for {FALLBACK_TIME:g} s")

    def _on_change(self) -> None:
        if self.mode in (Mode.HOLDING, Mode.LATCHED):
            self._controller.hold()
        elif self.mode is Mode.ACTIVE:
            self._controller.activate()
        self._fallback_since = None
        self._changed()
        self._publish()
        log = self._node.get_logger()
        if self.mode is Mode.LATCHED:
            log.error(f"{self.text}; all joints are braked and requests rejected until then")
        else:
            log.info(self.text)

    def _publish(self) -> None:
        message = ControllerMode(mode=self.logic.mode.value, reason=self.logic.reason)
        message.header.stamp = time_from_seconds(self._now)
        self._publisher.publish(message)

    def _serve(self, name: str, _: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        refused = getattr(self.logic, name)()
        answer.success = not refused
        answer.message = refused or self.text
        return answer
