"""Contacts: rows against finite differences, bounds that follow a plan, forces within them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ghc_controller.constraints import ConstraintSet
from ghc_controller.contacts import (
    BoundsInForce,
    Contact,
    ContactSet,
    FrictionCone,
    NormalForce,
    SurfaceContact,
)
from ghc_controller.contacts.registry import make_contact
from ghc_controller.controller import Controller
from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.formulations import FORMULATIONS, ContactRows
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.previews.preview import CONTACT_FORCES, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import Robot, load_robot_config
from ghc_controller.schema.reader import Fields
from ghc_controller.settings import Settings
from ghc_controller.types import Array, RobotState

STEP = 1e-6  # [s] of finite differences
SQUARE = [[0.05, 0.03, 0.1], [-0.05, 0.03, 0.1], [0.05, -0.03, 0.1], [-0.05, -0.03, 0.1]]


@pytest.fixture(scope="module")
def robot() -> Robot:
    """An arm; its contacts are those of each test."""
    return load_robot_config(find_robot("kuka_lwr"))


def _contact(robot: Robot, **fields: object) -> Contact:
    entry = {"name": "tip", "frame": "tool", "points": [[0, 0, 0]], "normal": [0, 0, 1]} | fields
    return make_contact(Fields(entry, "test"), robot.model)


def _rows(robot: Robot, contact: Contact) -> ContactRows:
    contacts = ContactSet([contact])
    bounds = BoundsInForce([replace(contact, active=True)]).at(0.0)
    rows = contacts.rows(robot.model, bounds, ReferenceSchedule([]), 0.0)
    limits = ConstraintSet([NormalForce(contacts), FrictionCone(contacts)], robot.model)
    model = robot.model
    state = RobotState(0.0, model.q.copy(), model.v.copy())
    limits.update(model, model.dynamics, state, None, 1e-3, rows)
    rows = limits.on_forces(rows)
    assert rows is not None
    return rows


def _points(model: RobotModel, contact: Contact, q: Array) -> Array:
    """(p, 3) world positions of the points at posture q."""
    model.update(q, np.zeros(model.nv))
    frame = model.frame(contact.frame_id)
    return np.array([frame.position + frame.rotation @ point for point in contact.points])


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("points", [[[0, 0, 0]], SQUARE[:2], SQUARE])
def test_rows_are_the_motion_of_the_points(
    robot: Robot, friction: float, points: list[list[float]]
) -> None:
    """Force Jacobian and drift against finite differences of the points along the axes."""
    model, rng = robot.model, np.random.default_rng(3)
    contact = _contact(robot, points=points, friction=friction, normal=[0.3, -0.2, 1.0])
    q, v = rng.normal(size=model.nq), rng.normal(size=model.nv)
    before, now, after = (_points(model, contact, q + s * STEP * v) for s in (-1.0, 0.0, 1.0))
    model.update(q, v)
    rows = _rows(robot, contact)
    speed = ((after - before) / (2.0 * STEP)) @ contact.force_axes.T
    assert np.allclose(rows.force_jacobian @ v, speed.ravel(), atol=1e-7)
    if isinstance(contact, SurfaceContact):
        return  # held by the six coordinates of its frame
    step = 1e-4
    before, now, after = (_points(model, contact, q + s * step * v) for s in (-1.0, 0.0, 1.0))
    drift = ((after - 2.0 * now + before) / step**2) @ contact.force_axes.T
    expected = -drift.ravel() - 20.0 * speed.ravel()
    assert np.allclose(rows.drift_target, expected, atol=1e-4)


def test_axes_are_right_handed_about_the_normal(robot: Robot) -> None:
    for normal in np.random.default_rng(0).normal(size=(20, 3)):
        axes = _contact(robot, normal=normal.tolist()).axes
        assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) > 0.0
        assert np.allclose(axes[2], normal / np.linalg.norm(normal))


def test_pyramid_lies_in_the_cone(robot: Robot) -> None:
    """Whatever meets the linear rows meets Coulomb's law, eq. 5.3; pulling does not."""
    contact = _contact(robot, friction=0.6)
    rows = _rows(robot, contact)
    cone = rows.force_matrix[rows.bounds :]
    forces = np.random.default_rng(1).normal(size=(2000, 3))
    inside = (forces @ cone.T <= 0.0).all(axis=1)
    assert inside.sum() > 20
    assert (np.linalg.norm(forces[inside, :2], axis=1) <= 0.6 * forces[inside, 2] + 1e-12).all()


@pytest.mark.parametrize("formulation", sorted(FORMULATIONS))
def test_the_force_follows_its_reference_up_to_the_bound(robot: Robot, formulation: str) -> None:
    """F_n = F_ref while the bounds allow it, then the bound; the contact stays still."""
    contact = _contact(robot, friction=0.4, active=True, force_task={"weight": 1.0})
    controller = Controller(
        replace(robot, contacts=(contact,)),
        Settings(formulation=formulation, torque_rate_limit=0.0),
    )
    q = np.array([0.0, 0.4, 0.1, 1.0, -0.4, -0.9, 0.0])
    state = RobotState(0.0, q, 0.1 * np.ones(7), np.zeros(7))
    controller.observe(state)
    task = controller.schedule_of("tip").task("tip")
    controller.add_reference(
        ReferenceTrajectory.for_task(task, np.zeros(1), np.ones((1, 1)), wrench=[[15.0]])
    )
    for upper, expected in ((50.0, 15.0), (9.0, 9.0), (0.0, 0.0)):
        controller.force_bounds.follow(_plan(["tip"], [0.0], [upper]))
        result = controller.step(state)
        rows = controller.problem().contacts
        assert rows is not None
        force = controller.contacts.normal_forces((True,), result.solution.force)
        assert force[0] == pytest.approx(expected, abs=5e-3)
        x = result.solution.acceleration
        assert np.allclose(rows.jacobian @ x, rows.drift_target, atol=1e-6)
        dynamics = controller.model.dynamics
        left = dynamics.mass_matrix @ x + dynamics.bias
        left -= rows.force_jacobian.T @ result.solution.force
        assert np.allclose(left, result.torque, atol=1e-6)
        report = controller.report()
        assert report.contacts.names == ("tip",)
        assert ("contact.tip.upper" in report.active_constraints) == (upper < 15.0)


def test_bounds_that_torques_cannot_meet_give_way_and_are_named(robot: Robot) -> None:
    """A smallest force that would need more torque than there is yields, by name."""
    contact = _contact(robot, friction=0.4, active=True, force_upper=6000.0)
    controller = Controller(replace(robot, contacts=(contact,)), Settings(torque_rate_limit=0.0))
    q = np.array([0.0, 0.4, 0.1, 1.0, -0.4, -0.9, 0.0])
    controller.force_bounds.follow(_plan(["tip"], [5000.0], [6000.0]))
    result = controller.step(RobotState(0.0, q, np.zeros(7), np.zeros(7)))
    assert (np.abs(result.torque) <= controller.model.torque_limit + 1e-9).all()
    assert any(slack.name == "contact.tip" for slack in controller.report().slack)
    assert controller.counts["qp_failures"] == 0


def _plan(names: list[str], lower: list[float], upper: list[float], on: bool = True) -> Preview:
    c = len(names)
    return Preview(
        CONTACT_FORCES,
        0.0,
        0.5,
        tuple(names),
        np.repeat(np.array(lower)[:, None], 3, axis=1),
        np.repeat(np.array(upper)[:, None], 3, axis=1),
        (True,) * c,
        (PreviewStatus.SMOOTHED,) * c,
        (False,) * c,
        True,
    )


def test_after_its_plan_a_contact_holds_or_is_released(robot: Robot) -> None:
    held = _contact(robot, name="held", force_upper=100.0)
    freed = _contact(robot, name="freed", force_upper=100.0, on_stale="release")
    untold = _contact(robot, name="untold", active=True, force_upper=70.0)
    bounds = BoundsInForce([held, freed, untold])
    bounds.follow(_plan(["held", "freed"], [1.0, 1.0], [9.0, 9.0]))
    now, later = bounds.at(1.0), bounds.at(1.1)
    assert now.upper.tolist() == [9.0, 9.0, 70.0]
    assert now.stale == ()
    assert later.upper.tolist() == [9.0, 100.0, 70.0]
    assert later.stale == ("held", "freed")
    assert now.active == later.active == (True, True, True)
    bounds.reset()
    assert bounds.at(0.0).active == (False, False, True)


def test_of_a_plan_the_contacts_that_the_robot_lacks_are_left_out(robot: Robot) -> None:
    bounds = BoundsInForce([_contact(robot, force_upper=100.0)])
    plan = _plan(["heel", "tip", "toe"], [1.0, 2.0, 3.0], [7.0, 8.0, 9.0])
    reasons = [str(error) for error in bounds.follow(plan)]
    assert reasons == ["unknown contact 'heel'; known: tip", "unknown contact 'toe'; known: tip"]
    assert bounds.planned == ("tip",)
    for time, stale in ((0.0, ()), (1.0, ()), (1.1, ("tip",))):
        now = bounds.at(time)
        assert (now.lower.tolist(), now.upper.tolist()) == ([2.0], [8.0])
        assert (now.active, now.stale) == ((True,), stale)
    assert bounds.largest_ahead(0, 0.0, 0.5) == 8.0
    assert bounds.follow(_plan(["tip"], [0.0], [4.0])) == ()
    assert bounds.at(0.0).upper.tolist() == [4.0]


def test_a_plan_for_unknown_contacts_alone_leaves_the_bounds_to_the_file(
    robot: Robot,
) -> None:
    bounds = BoundsInForce([_contact(robot, force_upper=100.0)])
    assert len(bounds.follow(_plan(["heel"], [0.0], [1.0]))) == 1
    assert bounds.planned == ()
    for time in (0.0, 5.0):
        now = bounds.at(time)
        assert (now.upper.tolist(), now.active, now.stale) == ([100.0], (False,), ())


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"frame": "nose"}, "frame: 'nose' given; known: "),
        ({"points": [[0, 0]]}, "points[0]: 3 numbers expected, 2 given"),
        ({"friction": -0.1}, "friction: a number >= 0 expected"),
        ({"force_lower": 5.0, "force_upper": 1.0}, "force_lower: 5 N given"),
        ({"on_stale": "drop"}, "on_stale: 'drop' given; known: hold, release"),
        ({"stiff": 1}, "stiff: unknown field"),
    ],
)
def test_bad_fields_are_named(robot: Robot, fields: dict[str, object], words: str) -> None:
    with pytest.raises(ConfigurationError) as error:
        _contact(robot, **fields)
    assert words in str(error.value)


def test_a_normal_needs_a_direction_and_names_must_differ(robot: Robot) -> None:
    with pytest.raises(InvalidValue, match="direction expected"):
        _contact(robot, normal=[0, 0, 0])
    with pytest.raises(InvalidValue, match="given twice"):
        ContactSet([_contact(robot), _contact(robot)])


def test_friction_use_is_the_share_of_the_cone(robot: Robot) -> None:
    """Of the worst point that carries something; 0 without friction, or off."""
    contacts = ContactSet(
        [
            _contact(robot, name="rough", points=SQUARE[:2], friction=0.5, active=True),
            _contact(robot, name="smooth", friction=0.0, active=True),
            _contact(robot, name="off", friction=0.5),
        ]
    )
    bounds = BoundsInForce(contacts.contacts).at(0.0)
    robot.model.update(np.zeros(7), np.zeros(7))
    contacts.rows(robot.model, bounds, ReferenceSchedule([]), 0.0)
    force = np.array([3.0, 4.0, 20.0, 1.0, 0.0, 0.01, 7.0])
    use = contacts.friction_use(bounds.active, force)
    assert use == pytest.approx([0.5, 0.0, 0.0])
    assert contacts.normal_forces(bounds.active, force) == pytest.approx([20.01, 7.0, 0.0])


def test_a_hold_that_is_left_before_the_next_state_leaves_force_tasks_off(robot: Robot) -> None:
    contact = _contact(robot, friction=0.4, active=True, force_task={"weight": 1.0})
    controller = Controller(replace(robot, contacts=(contact,)))
    q, v = np.full(7, 0.4), np.zeros(7)
    before = controller.step(RobotState(0.0, q, v)).torque
    controller.hold()
    controller.activate()
    after = controller.step(RobotState(1e-3, q, v)).torque
    assert np.abs(after - before).max() < 1.001  # [Nm] the rate limit
    assert controller.force_references.current("tip", 1e-3).wrench is None
