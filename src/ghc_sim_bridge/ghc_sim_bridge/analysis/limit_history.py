"""A joint or a distance against its moving limits: the current ones, and those of the script."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ghc_controller.constraints.rows.body_distance import BodyDistance
from ghc_controller.previews.preview import BODY_MARGINS, JOINT_LIMITS
from ghc_controller.robot.robot import Robot
from ghc_controller.types import Array
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule
from ghc_sim_bridge.analysis.generator_metrics import largest
from ghc_sim_bridge.logs.constraint_series import LOWER, UPPER, ConstraintSeries
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scenario.fields import Scenario

_SAME_TIME = 1e-6  # [s]


@dataclass(frozen=True, slots=True)
class LimitHistory:
    """One joint, or one distance, at the S reports of the controller; [rad], [Nm] or [m]."""

    unit: str
    time: Array  # (S,) [s]
    value: Array  # (S,) position, torque sent in answer, or least distance
    limits: Array  # (S, 2) in force
    raw: Array  # (S, 2) as scripted

    @property
    def looser_than_raw(self) -> float:
        """Largest excess of a limit in force over the raw one; 0: never looser."""
        return _excess(self.limits[:, LOWER], self.limits[:, UPPER], self.raw)

    @property
    def beyond_raw(self) -> float:
        """Largest excess of the joint over a raw limit."""
        return _excess(self.value, self.value, self.raw)

    @property
    def beyond_in_force(self) -> float:
        """Largest excess of the joint over a limit in force."""
        return _excess(self.value, self.value, self.limits)


def limit_histories(
    series: ConstraintSeries, scenario: Scenario, log: FullRateLog
) -> Mapping[str, LimitHistory]:
    """History of every limit that a preview moved and the scenario scripts."""
    histories = {}
    scripted = {
        "joint_limits": scenario.joint_limit_schedules,
        "torque_limits": scenario.torque_limit_schedules,
    }
    for name, limits in series.limits.items():
        kind, joint = name.split("/", 1)
        schedules = {schedule.name: schedule for schedule in scripted.get(kind, ())}
        if joint not in schedules or joint not in log.joint_names:
            continue
        column = log.joint_names.index(joint)
        rows = np.minimum(np.searchsorted(log.time, series.time - _SAME_TIME), len(log.time) - 1)
        values = (
            log.q[:, log.q.shape[1] - len(log.joint_names) :] if kind == JOINT_LIMITS else None
        )
        seen = log.torque[:, column] if values is None else values[:, column]
        raw = np.array([schedules[joint].at(time + _SAME_TIME) for time in series.time])
        unit = "rad" if kind == JOINT_LIMITS else "Nm"
        histories[name] = LimitHistory(unit, series.time, seen[rows], limits, raw)
    return histories


def margin_histories(
    series: ConstraintSeries, scenario: Scenario, log: FullRateLog, robot: Robot
) -> Mapping[str, LimitHistory]:
    """History of every margin that the scenario scripts: least distance of its pairs."""
    schedules: dict[str, LimitSchedule] = {}
    for schedule in scenario.body_margin_schedules:
        before = schedules.get(schedule.name)
        schedules[schedule.name] = before.followed_by(schedule, -np.inf) if before else schedule
    found = [one for one in robot.constraints if isinstance(one, BodyDistance)]
    rows = np.minimum(np.searchsorted(log.time, series.time - _SAME_TIME), len(log.time) - 1)
    histories = {}
    for constraint in found:
        names = [name for name in constraint.margins if f"{BODY_MARGINS}/{name}" in series.limits]
        names = [name for name in names if name in schedules]
        least = np.full((len(names), len(rows)), np.nan)
        for place, row in enumerate(rows if names else ()):
            model = robot.model
            model.update(log.configuration(row, model.joint_names), np.zeros(model.nv))
            distances = constraint.distances()
            for k, name in enumerate(names):
                least[k, place] = distances[list(constraint.pairs_of(name))].min()
        for k, name in enumerate(names):
            raw = np.array([schedules[name].at(time + _SAME_TIME) for time in series.time])
            key = f"{BODY_MARGINS}/{name}"
            limits = series.limits[key]
            histories[key] = LimitHistory("m", series.time, least[k], limits, raw)
    return histories


def _excess(least: Array, most: Array, limits: Array) -> float:
    below, above = limits[:, LOWER] - least, most - limits[:, UPPER]
    return largest(np.maximum(below, above))
