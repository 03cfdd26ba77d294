"""Limits that follow previews: never looser than the robot's file, stale rules, rejections."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.constraints import Constraint, Rows, Softness, Space, Tick
from ghc_controller.core.native import motion_of
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.previews.limits_in_force import LimitsInForce
from ghc_controller.previews.preview import JOINT_LIMITS, TORQUE_LIMITS, Preview, StaleRule
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.types import Array

JOINTS = ("a", "b")
FILE = np.array([2.0, 3.0])


def _preview(
    upper: Array, lower: float = -0.5, rows: tuple[str, ...] = ("b",), **changes: object
) -> Preview:
    values = np.tile(np.array(upper, dtype=float), (len(rows), 1))
    r, kind = len(rows), str(changes.pop("kind", JOINT_LIMITS))
    ends = ((True,) * r, (PreviewStatus.SMOOTHED,) * r, (False,) * r, True)
    low = np.full(values.shape, lower)
    return Preview(kind, 0.0, 0.1, rows, low, values, *ends, **changes)


def _limits(kind: str = JOINT_LIMITS) -> LimitsInForce:
    return LimitsInForce(kind, JOINTS, -FILE, FILE)


def test_a_preview_tightens_and_never_loosens() -> None:
    limits = _limits()
    assert limits.follow(_preview([1.0, 9.0, 0.5, 0.5, 0.5])) == ()
    assert limits.at(0.0).upper.tolist() == [2.0, 1.0]
    assert limits.at(0.1).upper.tolist() == [2.0, 3.0]
    assert limits.at(0.25).upper.tolist() == [2.0, 0.5]
    assert limits.at(0.25).lower.tolist() == [-2.0, -0.5]
    assert limits.planned == ("b",)


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        (StaleRule.OF_ROBOT, 1.0),
        (StaleRule.HOLD, 1.0),
        (StaleRule.RELEASE, 3.0),
        (StaleRule.TIGHTEN, 0.4),
    ],
)
def test_after_the_end_the_stale_rule_holds(rule: StaleRule, expected: float) -> None:
    limits = _limits()
    limits.follow(_preview([1.0, 0.4, 1.0, 1.0, 1.0], stale=rule))
    assert not limits.is_stale(0.4)
    assert limits.is_stale(0.5)
    assert limits.at(0.4).upper[1] == 1.0
    assert limits.at(0.5).upper[1] == expected
    assert not limits.at(0.5).rates.any()


def test_unknown_joints_are_left_out_and_the_rest_is_followed() -> None:
    limits = _limits()
    (left_out,) = limits.follow(_preview([1.0] * 5, rows=("b", "tail")))
    assert isinstance(left_out, UnknownName)
    assert str(left_out) == "unknown joint 'tail'; known: a, b"
    assert limits.planned == ("b",)
    assert limits.at(0.0).upper.tolist() == [2.0, 1.0]


@pytest.mark.parametrize(
    ("kind", "upper", "lower"),
    [
        (JOINT_LIMITS, [1.0, -0.6, 1.0], -0.5),  # crossed
        (JOINT_LIMITS, [9.0, 9.0, 9.0], 4.0),  # all that the file allows is excluded
        (TORQUE_LIMITS, [-0.1, -0.1, -0.1], -0.5),  # excludes zero
        (TORQUE_LIMITS, [1.0, np.nan, 1.0], -0.5),
        (JOINT_LIMITS, [1.0, 1.0, 1.0], np.nan),
    ],
)
def test_limits_that_cannot_be_kept_are_rejected_and_those_before_stay(
    kind: str, upper: list[float], lower: float
) -> None:
    limits = _limits(kind)
    limits.follow(_preview([1.0] * 5, kind=kind))
    with pytest.raises(InvalidValue, match="joint 'b'"):
        limits.follow(_preview(np.array(upper), lower, kind=kind))
    assert limits.at(0.0).upper.tolist() == [2.0, 1.0]


def test_rate_and_acceleration_of_a_cubic_are_exact_everywhere() -> None:
    """p = 1 + 2 t - 3 t^2 + 0.7 t^3 at points 0.1 s apart; also between and at the ends."""
    times = 0.1 * np.arange(8)
    points = (1.0 + 2.0 * times - 3.0 * times**2 + 0.7 * times**3)[None]
    for place in (0.0, 0.3, 1.0, 1.7, 3.5, 6.0, 6.9, 7.0):
        t = 0.1 * place
        rate, acceleration = motion_of(points, place, 0.1)
        assert rate[0] == pytest.approx(2.0 - 6.0 * t + 2.1 * t**2, abs=1e-12)
        assert acceleration[0] == pytest.approx(-6.0 + 4.2 * t, abs=1e-10)


def test_the_controller_obeys_and_reports_the_limits_and_forgets_them() -> None:
    """Torques of a posture far away stay inside limits of 0.5 Nm."""
    robot = ghc.load_robot("kuka_lwr")
    controller = ghc.Controller(robot, ghc.Settings.of(torque_rate_limit=0.0))
    state = ghc.RobotState(0.0, np.zeros(7), np.zeros(7), np.zeros(7))
    controller.start(state)
    controller.set_reference("posture", [1.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0])
    free = controller.step(state).torque
    assert abs(free[0]) > 0.5
    bound = _preview([0.5] * 5, -0.5, ("joint_1",), kind=TORQUE_LIMITS)
    assert controller.follow(bound) == ()
    assert abs(controller.step(state).torque[0]) <= 0.5 + 1e-9
    (limit,) = controller.report().limits
    assert (limit.kind, limit.joint, limit.lower, limit.upper) == (
        TORQUE_LIMITS,
        "joint_1",
        -0.5,
        0.5,
    )
    assert abs(controller.brake(state)[0]) <= 0.5 + 1e-9
    with pytest.raises(
        UnknownName, match="unknown kind of preview 'weather'; known: contact_forces"
    ):
        controller.follow(_preview([1.0] * 5, kind="weather"))
    controller.reset()
    controller.observe(state)
    controller.step(state)
    assert controller.report().limits == ()


class Weather(Constraint):
    """Bounds the acceleration of the first joint as a preview of its own kind says."""

    space, softness, kind = Space.ACCELERATION, Softness.SOFT, "weather"
    preview: Preview | None = None

    def follow(self, preview: Preview, now: float | None = None) -> tuple[UnknownName, ...]:
        self.preview = preview
        return ()

    def is_stale(self, time: float) -> bool:
        return self.preview is not None and self.preview.has_ended(time)

    def reset(self) -> None:
        self.preview = None

    def rows(self, tick: Tick) -> Rows | None:
        if self.preview is None:
            return None
        lower, upper = self.preview.at(tick.state.time)
        return Rows(np.eye(1, 7), lower, upper, ("weather.joint_1",))


def test_a_constraint_of_ones_own_follows_previews_of_its_kind() -> None:
    robot = ghc.load_robot("kuka_lwr")
    robot = replace(robot, constraints=(Weather("weather"),))
    controller = ghc.Controller(robot, ghc.Settings.of(torque_rate_limit=0.0))
    state = ghc.RobotState(0.0, np.zeros(7), np.zeros(7), np.zeros(7))
    controller.start(state)
    away = [1.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0]
    controller.set_reference("posture", away)
    free = controller.step(state).solution.acceleration[0]
    assert free > 0.3
    controller.follow(_preview([0.3] * 5, -0.3, ("joint_1",), kind="weather"))
    assert controller.step(state).solution.acceleration[0] == pytest.approx(0.3, abs=1e-6)
    assert controller.counts["stale_ticks"] == 0
    controller.step(replace(state, time=1.0))
    assert controller.counts["stale_ticks"] == 1
    controller.reset()
    controller.observe(state)
    controller.set_reference("posture", away)
    assert controller.step(state).solution.acceleration[0] == pytest.approx(free, abs=1e-6)
    with pytest.raises(InvalidValue, match="two constraints follow previews of kind 'weather'"):
        ghc.Controller(replace(robot, constraints=(Weather("one"), Weather("two"))))


def test_braking_uses_each_side_of_a_torque_limit() -> None:
    """One that leaves a joint no positive torque takes nothing of the negative one."""
    settings = ghc.Settings.of(torque_rate_limit=0.0)
    controller = ghc.Controller.for_robot("kuka_lwr", settings)
    state = ghc.RobotState(0.0, np.full(7, 0.4), np.zeros(7))
    free = controller.brake(state)
    place = int(np.argmin(free))
    assert free[place] < -1.0
    name = controller.model.joint_names[place]
    for lower, upper, expected in ((-300.0, 0.0, free[place]), (-1.0, 9.0, -1.0)):
        controller.follow(_preview([upper] * 3, lower, (name,), kind=TORQUE_LIMITS))
        assert controller.brake(state)[place] == pytest.approx(expected, abs=1e-9)
