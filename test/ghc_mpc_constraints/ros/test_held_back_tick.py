"""A tick that waits for the sensor when the robot is reset is of a run that has ended."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from ghc_msgs.msg import ConstraintPreviews, ObstacleState, ObstacleStateArray

from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_controller.ros.wire.cdr import encode_tick
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.generators.obstacle_motion import ObstacleBounds
from ghc_mpc_constraints.obstacle_motion.settings import ObstacleSettings
from ghc_mpc_constraints.ros.early_messages import EarlyMessages
from ghc_mpc_constraints.ros.generator_node import GeneratorNode
from ghc_mpc_constraints.ros.inputs import make_input
from ghc_mpc_constraints.ros.tick_clock import TickClock

STEP_NS = 10_000_000  # [ns]


def _reading(stamp_ns: int) -> ObstacleStateArray:
    message = ObstacleStateArray()
    message.header.stamp = time_from_nanoseconds(stamp_ns)
    entry = ObstacleState(id="ball", protected_frame="tool", distance=0.5, safe_distance=0.1)
    entry.position[:], entry.normal[:] = [1.0, 0.0, 0.5], [-1.0, 0.0, 0.0]
    message.obstacles.append(entry)
    return message


def test_the_first_plan_of_a_run_is_that_of_its_first_tick() -> None:
    """The first reading of a run comes before its tick, as the bridge sends it."""
    plans: list[ConstraintPreviews] = []
    node: Any = GeneratorNode.__new__(GeneratorNode)
    node._name, node._generator = "obstacle_bounds", ObstacleBounds(ObstacleSettings())
    node._clock = TickClock(STEP_NS)
    node._reject = lambda *_: None
    parameters = SimpleNamespace(sensor_period=STEP_NS / NANOSECONDS)
    node._input = make_input(node._generator, parameters, node._clock, node._reject)
    node._early = EarlyMessages(node._clock)
    node._take_over = SimpleNamespace(waits=lambda *_: False, end=lambda: None)
    node._report = SimpleNamespace(ticked=lambda _: None)
    node._previews = SimpleNamespace(publish=plans.append)
    node._controller, node._held_back_ns = None, None

    begin_ns = 2 * NANOSECONDS
    node._clock.timeline.announce(0, 0)
    node._on_input(_reading(0))
    node._on_tick(encode_tick(0, 0))
    node._on_tick(encode_tick(STEP_NS, 0))  # its reading never comes: the robot is reset
    assert [nanoseconds_from_time(plan.header.stamp) for plan in plans] == [0]
    node._clock.timeline.announce(1, begin_ns)
    node._on_input(_reading(begin_ns))
    node._on_tick(encode_tick(begin_ns, 1))
    stamps = [(plan.epoch, nanoseconds_from_time(plan.header.stamp)) for plan in plans]
    assert stamps == [(0, 0), (1, begin_ns)]
