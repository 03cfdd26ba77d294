"""Generator of obstacle motion: measured positions in, a plan of virtual motion out, per tick."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ghc_controller.errors import GhcError
from ghc_controller.previews.motion import PlannedMotion, integrate, state_at
from ghc_controller.previews.preview import OBSTACLE_MOTION, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.schema.declared import check, declared, inline
from ghc_controller.schema.domains import NOT_NEGATIVE, POSITIVE
from ghc_controller.types import Array
from ghc_mpc_constraints.generator import Generator, Sensor, register_generator
from ghc_mpc_constraints.obstacle_motion.approach import ReactionTime
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement, frame_of
from ghc_mpc_constraints.obstacle_motion.virtual_obstacle import VirtualObstacle, at_rest
from ghc_mpc_constraints.previews.horizon import HORIZON, SMOOTHING, STEP, Horizon
from ghc_mpc_constraints.previews.motion_qp import MotionQp
from ghc_mpc_constraints.previews.motion_weights import (
    POWER,
    dynamic_weights,
    dynamic_weights_two_sided,
)

_STILL = np.zeros((0, 3))


@dataclass(frozen=True, slots=True)
class ObstacleSettings:
    """Settings of the generator; T, N T and gamma are those of the thesis' figure 4.5.

    Raises:
        InvalidValue: a number outside its range.
    """

    step: float = STEP
    horizon: float = HORIZON
    jerk_weight: float = declared(
        "gamma of eq. 4.14; 1e-8 to 1e-4", 1e-5, unit="s^6", domain=POSITIVE
    )
    dynamic_weighting: bool = declared(
        "weighting matrix D of eq. 4.15, against overshoot; false: constant weight", True
    )
    power: float = declared(
        "g of eq. 4.16; the lowest weight is 10^-g", POWER, unit="-", domain=NOT_NEGATIVE
    )
    reaction: ReactionTime = inline(ReactionTime)
    margin: float = declared(
        "beyond the safe distance, where virtual obstacles enter and leave",
        0.05,
        unit="m",
        domain=NOT_NEGATIVE,
    )
    stale_after: float = declared(
        "without a message: obstacles are taken to be closer", 0.5, unit="s", domain=POSITIVE
    )
    stale_margin: float = declared(
        "by which they are taken to be closer", 0.05, unit="m", domain=NOT_NEGATIVE
    )
    smoothing: bool = SMOOTHING

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, slots=True)
class Measurements:
    """Everything that a sensor sees at one instant."""

    seen: tuple[Measurement, ...]
    doubtful: tuple[str, ...] = ()  # ids whose measurement could not be used

    @classmethod
    def read(cls, message: Any, reject: Callable[[str], None]) -> Measurements:
        """Measurements of a ghc_msgs/ObstacleStateArray; a bad entry is rejected alone."""
        seen: dict[str, Measurement] = {}
        doubtful = []
        for entry in message.obstacles:
            try:
                seen[entry.id] = Measurement.read(entry)
            except GhcError as error:
                reject(str(error))
                doubtful.append(entry.id)
        return cls(tuple(seen.values()), tuple(doubtful))


@register_generator("obstacle_motion")
@register_generator("obstacle_bounds")
class ObstacleBounds(Generator):
    """Virtual motion of every obstacle over a receding horizon (eq. 4.11 to 4.16).

    The axis along the normal is bounded: at the end of the reaction time, and ever after, the
    virtual obstacle is no farther from the robot than the measured one (eq. 4.14c). The two
    tangents are smoothed alike, without a bound. The first jerk of a plan is applied: the next
    tick starts where the plan before says.
    """

    kind = OBSTACLE_MOTION
    settings_type = ObstacleSettings
    input = Sensor("constraints/obstacles", "ghc_msgs/ObstacleStateArray", Measurements.read)
    TROUBLE = ("held", "tightened", "stale")

    def __init__(self, settings: ObstacleSettings) -> None:
        """Make the constant matrices and compile.

        Raises:
            InvalidValue: a horizon that is no multiple of the step.
        """
        self.settings = settings
        self.horizon = Horizon.of(settings.step, settings.horizon)
        self.counts: Counter[str] = Counter()
        self._qp = MotionQp(self.horizon, settings.jerk_weight)
        self._no_limit = np.full(self.horizon.steps, np.inf)
        self._obstacles: dict[str, VirtualObstacle] = {}
        self._handed_over: dict[str, Array] = {}  # id -> state in force (3, 3)
        self._plan: Preview | None = None
        self._observed_at: float | None = None
        self._stale = False
        ramp = np.linspace(1.0, 0.0, self.horizon.steps)
        self._qp.solve(np.ones(3), ramp, np.ones_like(ramp), ramp)
        still = at_rest(np.zeros(3)), np.zeros((2, 3)), settings.step
        integrate(*still)
        state_at(*still, 0.0)

    @property
    def second_opinions(self) -> int:
        """How often the structured solve had to be repeated by another solver."""
        return self._qp.second.asked

    def observe(self, given: Measurements | Sequence[Measurement], now: float) -> None:
        """Take everything that the sensor sees at `now` [s]; what it leaves out has gone.

        Obstacles whose measurement could not be used stay where they were.
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
        """Start the obstacles that are inside from their motion in force, not from the edge."""
        for motion in in_force.motions:
            self.start_from(motion.id, motion.state)

    def start_from(self, id: str, state: Array) -> None:  # noqa: A002 - as in the messages
        """Start an obstacle that is inside from the motion in force (3, 3), not from the edge.

        Has no effect on an obstacle that this generator has planned already.
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
        """Forget everything: time starts again."""
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
            planned.append(self._plan_one(obstacle, time, old))
            self.counts[planned[-1].status.name.lower()] += 1
        self._plan = Preview.of_motions(
            time, self.horizon.step, self.horizon.steps, tuple(planned)
        )
        return self._plan

    def _watch_age(self, time: float) -> None:
        """Once the sensor is silent for too long, every obstacle may have come closer."""
        observed = self._observed_at
        if self._stale or observed is None or time - observed <= self.settings.stale_after:
            return
        self._stale = True
        self.counts["sensor_silent"] += 1
        for obstacle in self._obstacles.values():
            if obstacle.measurement is not None and obstacle.seen:
                obstacle.observe(obstacle.measurement.closer(self.settings.stale_margin), time)

    def _plan_one(
        self, obstacle: VirtualObstacle, time: float, old: PlannedMotion | None
    ) -> PlannedMotion:
        measurement = obstacle.measurement
        assert measurement is not None
        if not self.settings.smoothing:
            state, jerk = at_rest(measurement.position), _STILL
            status = PreviewStatus.RAW
        elif obstacle.outside:
            state, jerk, status = obstacle.state, _STILL, PreviewStatus.RAW
        else:
            state, jerk, status = self._smooth(obstacle, measurement, time, old)
        if self._stale and status in (PreviewStatus.SMOOTHED, PreviewStatus.RAW):
            status = PreviewStatus.STALE
        return PlannedMotion(
            measurement.id,
            measurement.frame,
            measurement.safe_distance,
            measurement.normal,
            state,
            jerk,
            status,
        )

    def _smooth(
        self,
        obstacle: VirtualObstacle,
        measurement: Measurement,
        time: float,
        old: PlannedMotion | None,
    ) -> tuple[Array, Array, PreviewStatus]:
        """State (3, 3), jerks (N, 3) and how they came about."""
        axes = frame_of(measurement.normal)
        raw = axes @ obstacle.reference.preview(self.horizon.times(time)[1:]).T  # (3, N)
        state = axes @ obstacle.state.T  # row = position, velocity, acceleration of an axis
        jerk = np.empty_like(raw)
        for axis in range(3):
            limit = raw[0] if axis == 0 else self._no_limit
            answer = self._qp.solve(state[axis], raw[axis], self._weights(raw[axis], axis), limit)
            if answer is None:
                return self._without_solution(obstacle.state, axes, raw, time, old)
            jerk[axis] = answer
        return obstacle.state, np.ascontiguousarray(jerk.T @ axes), PreviewStatus.SMOOTHED

    def _weights(self, raw: Array, axis: int) -> Array:
        if not self.settings.dynamic_weighting:
            return np.ones_like(raw)
        rule = dynamic_weights if axis == 0 else dynamic_weights_two_sided
        return rule(raw, self.settings.power)

    def _without_solution(
        self, state: Array, axes: Array, raw: Array, time: float, old: PlannedMotion | None
    ) -> tuple[Array, Array, PreviewStatus]:
        """The rest of the plan before; without one, at rest at the closest position ahead."""
        if old is not None and self._plan is not None:
            done = round((time - self._plan.start) / self._plan.step)
            if 0 <= done < len(old.jerk):
                return state, old.jerk[done:], PreviewStatus.HELD
        place = axes @ state[0]
        place[0] = min(place[0], raw[0].min())
        return at_rest(place @ axes), _STILL, PreviewStatus.TIGHTENED
