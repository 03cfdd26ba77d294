"""Touches that come early or late, breaks that take a while: force confirms the schedule."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ghc_controller.contacts import BoundsInForce, ContactSensing, NormalBounds
from ghc_controller.contacts.registry import make_contact
from ghc_controller.contacts.sensing_settings import Sensing
from ghc_controller.controller import Controller
from ghc_controller.previews.preview import CONTACT_FORCES, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.schema.reader import Fields
from ghc_controller.settings import Settings
from ghc_controller.types import RobotState

STEP, HORIZON, UPPER = 0.01, 1.5, 60.0  # [s], [s], [N]
SIDES = ("left", "right")
FORCE = np.array([0.0, 0.0, 20.0, 0.0, 0.0, 0.0])  # [N], [Nm]


class Foot:
    """One contact with a schedule: off before `make` [s], off again from `end` [s] on."""

    def __init__(self, make: float, end: float = np.inf, sensing: bool = True) -> None:
        entry: dict[str, object] = {"name": "foot", "frame": "tool", "points": [[0, 0, 0]]}
        entry |= {"normal": [0, 0, 1], "active": make <= 0.0}
        if sensing:
            entry["sensing"] = {
                "threshold": 5.0,
                "rise_rate": 100.0,
                "early": 0.5,
                "patience": 0.2,
            }
        robot = load_robot_config(find_robot("kuka_lwr"))
        self.contact = make_contact(Fields(entry, "test"), robot.model)
        self._make, self._end = make, end
        self._bounds = BoundsInForce([self.contact])
        self._sensing = ContactSensing((self.contact,), self._bounds)

    def at(self, time: float, touches: bool, measured: bool = True) -> NormalBounds:
        """Bounds at a time [s] at which the foot touches or not."""
        tick = np.floor(time / STEP + 1e-6) * STEP
        times = tick + STEP * np.arange(round(HORIZON / STEP) + 1)
        on = (times >= self._make - 1e-9) & (times < self._end - 1e-9)
        upper = np.where(on, UPPER, 0.0)[None]
        status = (PreviewStatus.RAW,)
        plan = Preview(
            CONTACT_FORCES,
            float(tick),
            STEP,
            ("foot",),
            0.0 * upper,
            upper,
            (bool(on[0]),),
            status,
            (False,),
            False,
        )
        self._bounds.follow(plan)
        return self.later(time, touches, measured)

    def later(self, time: float, touches: bool, measured: bool = True) -> NormalBounds:
        """Bounds at a time [s] for which no new plan has come."""
        wrenches = {"foot": FORCE * touches} if measured else {}
        return self._sensing.confirm(self._bounds.at(time), time, wrenches)


def test_a_late_touch_switches_on_when_it_is_felt_and_its_bound_rises_from_there() -> None:
    foot = Foot(make=1.0)
    assert foot.at(1.2, touches=False).active == (False,)
    for time, expected in ((1.3, 5.0), (1.4, 15.0), (1.4, 15.0), (2.5, UPPER)):
        bounds = foot.at(time, touches=True)
        assert bounds.active == (True,)
        assert bounds.upper[0] == pytest.approx(expected)


def test_an_early_touch_keeps_still_and_carries_little_before_its_time() -> None:
    foot = Foot(make=1.0)
    assert foot.at(0.3, touches=True).active == (False,)  # a scuff, long before
    early = foot.at(0.8, touches=True)
    assert early.active == (True,)
    assert early.upper[0] == 5.0
    assert foot.at(0.9, touches=False).active == (True,)  # it bounces: still about to be on
    on_time = foot.at(1.0, touches=True)
    assert (on_time.active, on_time.upper[0]) == ((True,), UPPER)


def test_a_break_waits_for_the_force_to_go_but_not_for_ever() -> None:
    foot = Foot(make=0.0, end=1.0)
    assert foot.at(0.9, touches=True).active == (True,)
    assert foot.at(1.1, touches=True).active == (True,)
    assert foot.at(1.15, touches=False).active == (False,)
    stuck = Foot(make=0.0, end=1.0)
    assert stuck.at(1.0, touches=True).active == (True,)
    assert stuck.at(1.21, touches=True).active == (False,)


@pytest.mark.parametrize("foot", [Foot(make=1.0, sensing=False), Foot(make=1.0)])
def test_without_a_sensor_the_schedule_counts(foot: Foot) -> None:
    measured = foot.contact.sensing is None
    assert foot.at(0.9, touches=True, measured=measured).active == (False,)
    assert foot.at(1.0, touches=False, measured=measured).active == (True,)


def test_a_contact_that_carries_at_the_first_look_keeps_its_load() -> None:
    """A controller that takes over a robot which leans on its hand does not unload it."""
    foot = Foot(make=0.01)  # off in robot.yaml, on in the plan
    bounds = foot.at(0.5, touches=True)
    assert bounds.active == (True,)
    assert bounds.upper[0] == UPPER


def test_a_silent_generator_breaks_no_contact_that_came_early() -> None:
    foot = Foot(make=1.0)
    foot.at(0.7, touches=False)
    assert foot.at(0.8, touches=True).active == (True,)
    for time in (1.5, 2.4, 2.8, 4.0):  # the last plan ends at 2.3 s
        assert foot.later(time, touches=True).active == (True,)


def _one_foot_felt() -> list[tuple[Controller, RobotState]]:
    """iCub on its left foot, by that foot alone; and with the right one on by a plan, not felt."""
    robot = load_robot_config(find_robot("icub"))
    left, right = (next(c for c in robot.contacts if c.name == f"{side}_sole") for side in SIDES)
    right = replace(right, active=False, sensing=Sensing())
    bounds = np.zeros((1, 3))
    plan = Preview(
        *(CONTACT_FORCES, 0.0, 1.0, ("right_sole",), bounds, bounds + 300.0),
        *((True,), (PreviewStatus.RAW,), (False,), False),
    )
    q = np.zeros(robot.model.nq)
    q[6] = 1.0
    state = RobotState(0.0, q, np.zeros(robot.model.nv), None, {"right_sole": np.zeros(6)})
    found = []
    for contacts in ((left,), (left, right)):
        controller = Controller(
            replace(robot, contacts=contacts),
            Settings.of(torque_rate_limit=0.0),
        )
        if right in contacts:
            controller.follow(plan)
        found.append((controller, state))
    return found


def test_braking_counts_on_no_contact_that_is_planned_and_not_felt() -> None:
    torques = [controller.brake(state) for controller, state in _one_foot_felt()]
    np.testing.assert_allclose(torques[1], torques[0], atol=1e-9)


def test_requests_are_judged_at_the_contacts_that_are_felt() -> None:
    """Also at a state that is looked at only; what is felt there is new to the next step."""
    measured = []
    for controller, state in _one_foot_felt():
        controller.observe(state)
        alpha = np.full(controller.priorities.alpha.shape, 0.25)  # no order: contacts matter
        measured.append(controller.solvability().measure(alpha))
        controller.step(state)
        assert controller.solvability().measure(alpha) == measured[-1]
    assert measured[1] == measured[0]
