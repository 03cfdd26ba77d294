"""Generator of obstacle motion: plans a virtual motion from measured positions at each tick."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.preview import OBSTACLE_MOTION, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.types import Array
from ghc_mpc_constraints.generator import Generator, Sensor, register_generator
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement, Measurements
from ghc_mpc_constraints.obstacle_motion.planner import Before, MotionPlanner
from ghc_mpc_constraints.obstacle_motion.settings import ObstacleSettings
from ghc_mpc_constraints.obstacle_motion.virtual_obstacle import VirtualObstacle
from ghc_mpc_constraints.previews.horizon import Horizon


@register_generator("obstacle_motion")
@register_generator("obstacle_bounds")
class ObstacleBounds(Generator):
    """Virtual motion of every obstacle over a receding horizon (eq. 4.11 to 4.16).

    The first jerk of a plan is applied: the next tick starts from the previous plan. How one
    obstacle is planned: MotionPlanner.
    """

    kind = OBSTACLE_MOTION
    settings_type = ObstacleSettings
    input = Sensor("constraints/obstacles", "ghc_msgs/ObstacleStateArray", Measurements.read)
    TROUBLE = ("held", "tightened", "stale")

    def __init__(self, settings: ObstacleSettings) -> None:
        """Compute the constant matrices.

        Raises:
            InvalidValue: the horizon is not a multiple of the step.
        """
        self.settings = settings
        self.horizon = Horizon.of(settings.step, settings.horizon)
        self.counts: Counter[str] = Counter()
        self._planner = MotionPlanner(settings, self.horizon)
        self._obstacles: dict[str, VirtualObstacle] = {}
        self._handed_over: dict[str, Array] = {}  # id -> current state (3, 3)
        self._plan: Preview | None = None
        self._observed_at: float | None = None
        self._stale = False

    @property
    def second_opinions(self) -> int:
        """How often the structured solve had to be repeated by another solver."""
        return self._planner.qp.second.asked

    def observe(self, given: Measurements | Sequence[Measurement], now: float) -> None:
        """Process all obstacles measured at `now` [s]; missing ones have disappeared.

        Obstacles with invalid measurements stay where they were.
        """
        self._observed_at, self._stale = now, False
        if not isinstance(given, Measurements):
            given = Measurements(tuple(given))
        measurements, doubtful = given.seen, given.doubtful
        for measurement in measurements:
            obstacle = self._obstacles.get(measurement.id)
            if obstacle is None:
                obstacle = VirtualObstacle(self.settings.margin, self.settings.reaction)
                handed_over = self._handed_over.pop(measurement.id, None)
                if handed_over is not None:
                    obstacle.enter(handed_over, now)
                self._obstacles[measurement.id] = obstacle
            obstacle.observe(measurement, now)
        for name in self._obstacles.keys() - {m.id for m in measurements} - set(doubtful):
            self._obstacles[name].vanish(now)

    def take_over(self, in_force: Preview) -> None:
        """Start the obstacles that are inside from their current motion, not from the edge."""
        for motion in in_force.motions:
            self.start_from(motion.id, motion.state)

    def start_from(self, id: str, state: Array) -> None:  # noqa: A002 - as in the messages
        """Start an obstacle that is inside from the current motion (3, 3), not from the edge.

        Has no effect on an obstacle that this generator has already planned.
        """
        if not np.isfinite(state).all():
            return
        obstacle, now = self._obstacles.get(id), self._observed_at
        if obstacle is None:
            self._handed_over[id] = state.copy()
        elif self._plan is None and not obstacle.outside and now is not None:
            obstacle.enter(state.copy(), now)
            if obstacle.measurement is not None:
                obstacle.observe(obstacle.measurement, now)

    def reset(self) -> None:
        """Discard everything: time restarts."""
        self._obstacles.clear()
        self._handed_over.clear()
        self._plan = None
        self._observed_at = None
        self._stale = False

    def tick(self, time: float) -> Preview:
        """Plan from `time` [s]."""
        self._watch_age(time)
        before = {p.id: p for p in self._plan.motions} if self._plan is not None else {}
        planned = []
        for name in sorted(self._obstacles):
            obstacle = self._obstacles[name]
            old = before.get(name)
            if old is not None and self._plan is not None and old.moves:
                obstacle.advance(old.at(time - self._plan.start, self._plan.step))
            if obstacle.gone or (not self.settings.smoothing and not obstacle.seen):
                del self._obstacles[name]
                continue
            planned.append(self._planned(obstacle, time, old))
            self.counts[planned[-1].status.name.lower()] += 1
        self._plan = Preview.of_motions(
            time, self.horizon.step, self.horizon.steps, tuple(planned)
        )
        return self._plan

    def _watch_age(self, time: float) -> None:
        """Move all obstacles closer after a sensor timeout."""
        observed = self._observed_at
        if self._stale or observed is None or time - observed <= self.settings.stale_after:
            return
        self._stale = True
        self.counts["sensor_silent"] += 1
        for obstacle in self._obstacles.values():
            if obstacle.measurement is not None and obstacle.seen:
                obstacle.observe(obstacle.measurement.closer(self.settings.stale_margin), time)

    def _planned(
        self, obstacle: VirtualObstacle, time: float, old: PlannedMotion | None
    ) -> PlannedMotion:
        """Motion of one obstacle; it is marked if the sensor has timed out."""
        before = None
        if old is not None and self._plan is not None:
            before = Before(old.jerk, round((time - self._plan.start) / self._plan.step))
        motion = self._planner.plan(obstacle, time, before)
        if self._stale and motion.status in (PreviewStatus.SMOOTHED, PreviewStatus.RAW):
            return replace(motion, status=PreviewStatus.STALE)
        return motion
