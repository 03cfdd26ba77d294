"""Drives one generator node over DDS as fast as it replies, as robot, planner and sensor."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np
from ghc_msgs.msg import Tick
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

import ghc_controller as ghc
from ghc_controller.ros.qos import CONTROL_PUBLISHER_QOS, PREVIEW_SUBSCRIBER_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds

STEP_NS = 10_000_000  # [ns] T: ticks at 100 Hz
CHANGE_EVERY = 10  # ticks
_DEADLINE = 60.0  # [s] wall, for one plan
_REPEAT = 0.1  # [s] wall until a state is sent again


class Driver(ABC):
    """Publishes ticks and inputs, waits for the plan of each tick."""

    generator: str  # executable, and name of the node
    plan: type[Any]  # message
    topic: str  # of the plans

    def __init__(self, context: Context) -> None:
        """Create the node that communicates with the generator."""
        self.node = Node("surroundings", context=context)
        self.plans = 0
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self._rng = np.random.default_rng(0)
        self._ticks = self.node.create_publisher(Tick, "ghc/tick", CONTROL_PUBLISHER_QOS)
        self._newest_ns = -1
        self._handled = 0  # contacts or obstacles of the newest plan
        self.node.create_subscription(self.plan, self.topic, self._on_plan, PREVIEW_SUBSCRIBER_QOS)

    @abstractmethod
    def change(self, stamp_ns: int) -> None:
        """Publish new inputs as of a stamp [ns]."""

    @abstractmethod
    def count_of(self, plan: Any) -> int:
        """Number of contacts or obstacles in a plan."""

    @property
    def handled(self) -> int:
        """Number of contacts or obstacles in the newest plan."""
        return self._handled

    def tick(self, number: int, check: Callable[[], None]) -> None:
        """Publish a tick, and wait for its plan; `check` looks after the node.

        Raises:
            GhcError: none came, or what `check` raises.
        """
        stamp_ns = number * STEP_NS
        message = Tick(start=time_from_nanoseconds(stamp_ns))
        deadline, again = time.monotonic() + _DEADLINE, 0.0
        while self._newest_ns < stamp_ns:
            now = time.monotonic()
            if now > deadline:
                raise ghc.GhcError(f"{self.generator}: no plan at {stamp_ns * 1e-9:g} s simulated")
            if now > again:
                check()
                if number % CHANGE_EVERY == 0:
                    self.change(stamp_ns)
                self._ticks.publish(message)
                again = now + _REPEAT
            self._executor.spin_once(timeout_sec=0.02)
        self.plans += 1

    def close(self) -> None:
        """End the node."""
        self._executor.shutdown()
        self.node.destroy_node()

    def _on_plan(self, plan: Any) -> None:
        self._newest_ns = max(self._newest_ns, nanoseconds_from_time(plan.header.stamp))
        self._handled = self.count_of(plan)
