"""Inputs of each generator: replaced schedules, jumping obstacles."""

from __future__ import annotations

import numpy as np
from ghc_msgs.msg import ConstraintPreviews, ObstacleStateArray
from ghc_msgs.msg import ContactSchedule as ContactScheduleMessage
from rclpy.context import Context

from benchmarks.soak.driver import CHANGE_EVERY, STEP_NS, Driver
from ghc_controller.ros.qos import SCHEDULE_QOS, SENSOR_PUBLISHER_QOS
from ghc_controller.ros.time import time_from_nanoseconds
from ghc_mpc_constraints import ContactSchedule, Measurement
from ghc_mpc_constraints.ros.conversions import measurement_message, schedule_message

_COUNT = 4  # contacts or obstacles


class ForceDriver(Driver):
    """Contacts whose schedules are replaced ten times a second, in turns."""

    generator = "contact_force_bounds"
    plan = ConstraintPreviews
    topic = "constraints/preview"

    def __init__(self, context: Context) -> None:
        """See Driver."""
        super().__init__(context)
        self._schedules = self.node.create_publisher(
            ContactScheduleMessage, "constraints/contact_schedule", SCHEDULE_QOS
        )

    def change(self, stamp_ns: int) -> None:
        """See Driver."""
        now, turn = stamp_ns * 1e-9, stamp_ns // (CHANGE_EVERY * STEP_NS)
        times = (now + 0.3 + 0.4 * np.arange(4)).tolist()
        lower = self._rng.uniform(0.0, 10.0, 4).tolist()
        upper = self._rng.uniform(20.0, 60.0, 4).tolist()
        schedule = ContactSchedule.checked(f"contact_{turn % _COUNT}", times, lower, upper)
        self._schedules.publish(schedule_message(schedule))

    def count_of(self, plan: ConstraintPreviews) -> int:
        """See Driver."""
        return len(plan.previews[0].rows)


class MotionDriver(Driver):
    """Obstacles that jump at 10 Hz; sometimes one disappears and reappears."""

    generator = "obstacle_bounds"
    plan = ConstraintPreviews
    topic = "constraints/preview"

    def __init__(self, context: Context) -> None:
        """See Driver."""
        super().__init__(context)
        self._sensor = self.node.create_publisher(
            ObstacleStateArray, "constraints/obstacles", SENSOR_PUBLISHER_QOS
        )

    def change(self, stamp_ns: int) -> None:
        """See Driver."""
        message = ObstacleStateArray()
        message.header.stamp = time_from_nanoseconds(stamp_ns)
        hidden = self._rng.integers(2 * _COUNT)  # half of the time all are seen
        for i in range(_COUNT):
            distance, aside = self._rng.uniform(0.2, 0.5), self._rng.uniform(-0.05, 0.05, 2)
            position, normal = [distance, *aside.tolist()], [-1.0, 0.0, 0.0]
            measurement = Measurement.checked(
                f"obstacle_{i}", "tool", position, normal, distance, 0.4
            )
            if i != hidden:
                message.obstacles.append(measurement_message(measurement))
        self._sensor.publish(message)

    def count_of(self, plan: ConstraintPreviews) -> int:
        """See Driver."""
        return len(plan.previews[0].motions)


DRIVERS: tuple[type[Driver], ...] = (ForceDriver, MotionDriver)
