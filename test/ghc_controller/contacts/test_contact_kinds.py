"""Kinds of contacts: which motion each keeps still, where its forces act, which are possible."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.contacts import Contact, SlidingContact, SurfaceContact
from ghc_controller.contacts.registry import make_contact
from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.reader import Fields
from ghc_controller.types import Array, RobotState
from ghc_sim_bridge import Simulator

STEP = 1e-4  # [s] of finite differences
SQUARE = [[0.05, 0.03, 0.1], [-0.05, 0.03, 0.1], [0.05, -0.03, 0.1], [-0.05, -0.03, 0.1]]


@pytest.fixture(scope="module")
def model() -> RobotModel:
    """An arm."""
    return ghc.load_robot("kuka_lwr").model


def _contact(model: RobotModel, **fields: object) -> Contact:
    entry = {"name": "tip", "frame": "tool", "points": SQUARE, "normal": [0.3, -0.2, 1.0]} | fields
    return make_contact(Fields(entry, "test"), model)


def _rows(model: RobotModel, contact: Contact) -> tuple[Array, Array, Array]:
    """Force map (c, n), motion rows (q, n) and their accelerations (q,)."""
    forces, q = np.empty((contact.forces, model.nv)), contact.motion_rows
    motion, target = np.empty((q, model.nv)), np.empty(q)
    frame = model.frame(contact.frame_id)
    contact.write_forces(frame, forces)
    contact.write_motion(frame, motion, target)
    return forces, motion, target


def _points(model: RobotModel, contact: Contact, q: Array) -> Array:
    model.update(q, np.zeros(model.nv))
    frame = model.frame(contact.frame_id)
    return np.array([frame.position + frame.rotation @ point for point in contact.points])


def test_the_default_kind_is_what_friction_and_points_make_of_it(model: RobotModel) -> None:
    assert type(_contact(model)) is SurfaceContact
    assert type(_contact(model, points=SQUARE[:2])) is Contact
    assert type(_contact(model, friction=0.0)) is Contact
    assert type(_contact(model, kind="point")) is Contact
    assert type(_contact(model, kind="sliding")) is SlidingContact
    for wrong in ({"points": SQUARE[:2]}, {"friction": 0.0}):
        with pytest.raises(InvalidValue, match="3 or more points and friction expected"):
            _contact(model, kind="surface", **wrong)


@pytest.mark.parametrize("kind", ["point", "surface", "sliding"])
def test_accelerations_of_the_motion_rows_keep_it_still(model: RobotModel, kind: str) -> None:
    """With J x = target the points accelerate by -20 v along what is held: central differences."""
    rng = np.random.default_rng(4)
    contact = _contact(model, kind=kind)
    q, v = rng.normal(size=model.nq), rng.normal(size=model.nv)
    model.update(q, v)
    _, motion, target = _rows(model, contact)
    assert motion.shape[0] == {"point": 12, "surface": 6, "sliding": 4}[kind]
    if kind == "surface":
        frame = model.frame(contact.frame_id)
        assert np.array_equal(motion, frame.jacobian)
        return  # that of the frame is held by the tests of the model
    x = rng.normal(size=model.nv)
    places = [
        _points(model, contact, q + v * t + 0.5 * x * t * t) @ contact.force_axes.T
        for t in (-STEP, 0.0, STEP)
    ]
    speed = (places[2] - places[0]).ravel() / (2.0 * STEP)
    change = (places[2] - 2.0 * places[1] + places[0]).ravel() / STEP**2
    assert np.allclose(motion @ x - target, change + 20.0 * speed, atol=1e-4)


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_friction_of_a_sliding_contact_acts_against_its_motion(
    model: RobotModel, friction: float
) -> None:
    """Power of its forces: what moves along the normal, less mu F |v_t| of every point."""
    rng = np.random.default_rng(5)
    contact = _contact(model, kind="sliding", friction=friction)
    q, v = rng.normal(size=model.nq), rng.normal(size=model.nv)
    before, after = (_points(model, contact, q + s * 1e-6 * v) for s in (-1.0, 1.0))
    velocity = (after - before) / 2e-6
    model.update(q, v)
    force_map, motion, _ = _rows(model, contact)
    force = rng.uniform(1.0, 20.0, 4)
    along = velocity - np.outer(velocity @ contact.axes[2], contact.axes[2])
    speed = np.linalg.norm(along, axis=1)
    assert (speed > 0.01).all()
    power = force @ (motion @ v) - friction * force @ speed
    assert force @ force_map @ v == pytest.approx(power, abs=1e-5)
    model.update(q, np.zeros(model.nv))
    at_rest, motion, _ = _rows(model, contact)
    assert np.array_equal(at_rest, motion), "none that could hold it"
    assert np.array_equal(contact.cone(), -np.eye(4))
    assert contact.friction_use(force) == 0.0


def test_accelerations_of_a_rolling_contact_keep_what_touches_still(model: RobotModel) -> None:
    """J x - target is the rate of c' - w x r n, and 20 1/s of it: central differences. Seed 6."""
    rng = np.random.default_rng(6)
    radius = 0.04
    contact = _contact(model, kind="rolling", radius=radius)
    normal = contact.axes[2]

    def slip(q: Array, v: Array) -> Array:
        model.update(q, v)
        frame = model.frame(contact.frame_id)
        to_plane = contact.points @ frame.rotation.T - radius * normal
        velocity = frame.velocity[:3] + np.cross(frame.velocity[3:], to_plane)
        return np.array(velocity @ contact.axes.T).ravel()

    q, v, x = rng.normal(size=(3, model.nv))
    before, here, after = (
        slip(q + v * t + 0.5 * x * t * t, v + x * t) for t in (-STEP, 0.0, STEP)
    )
    model.update(q, v)
    forces, motion, target = _rows(model, contact)
    assert np.array_equal(forces, motion)
    assert np.allclose(motion @ v, here, atol=1e-12)
    rate = (after - before) / (2.0 * STEP)
    assert np.allclose(motion @ x - target, rate + 20.0 * here, atol=1e-5)


def test_a_rolling_contact_needs_friction_and_a_radius(model: RobotModel) -> None:
    with pytest.raises(InvalidValue, match="friction 0 given"):
        _contact(model, kind="rolling", radius=0.1, friction=0.0)
    with pytest.raises(ConfigurationError, match="radius"):
        _contact(model, kind="rolling")
    with pytest.raises(ConfigurationError, match="radius"):
        _contact(model, kind="point", radius=0.1)


def _sliding_arm(**contact: Any) -> ghc.Robot:
    urdf = ghc.load_robot("kuka_lwr").urdf
    entry = {"name": "tip", "frame": "tool", "points": [[0, 0, 0]], "normal": [0, 0, 1]}
    return ghc.Robot.from_urdf(
        urdf,
        tasks=[
            ghc.frame_position("hand", "tool", stiffness=30.0, damping=20.0),
            ghc.posture("posture", stiffness=30.0, damping=20.0),
        ],
        hierarchy="hand > posture",
        contacts=[entry | {"active": True, "force_lower": 5.0} | contact],
    )


@pytest.mark.parametrize("formulation", ["cascade", "balanced", "hqp"])
def test_a_sliding_contact_presses_and_moves_along_its_plane(formulation: str) -> None:
    """The dynamics hold with friction; the task moves in the plane, and not along the normal."""
    state = Simulator("kuka_lwr", control_dt=1e-3).state()
    v = np.full(7, 0.1)
    state = RobotState(0.0, state.q, v)
    settings = ghc.Settings(torque_rate_limit=0.0, formulation=formulation, velocity_limits=False)
    results = {}
    for friction in (0.0, 0.3):
        controller = ghc.Controller(_sliding_arm(kind="sliding", friction=friction), settings)
        controller.start(state)
        model = controller.model
        place = model.frame_position(model.frame_id("tool")).copy()
        controller.set_reference("hand", (place + [0.05, 0.02, 0.1]).tolist())
        result = controller.step(state)
        assert result.status is ghc.StepStatus.SOLVED
        solution, frame = result.solution, model.frame(model.frame_id("tool"))
        acceleration = frame.jacobian[:3] @ solution.acceleration + frame.drift[:3]
        assert acceleration[2] == pytest.approx(-20.0 * frame.velocity[2], abs=1e-6)
        force = float(solution.force[0])
        assert force == pytest.approx(5.0, abs=1e-3)
        along = frame.velocity[:3] * [1.0, 1.0, 0.0]
        push = np.array([0.0, 0.0, force]) - friction * force * along / np.linalg.norm(along)
        dynamics = model.dynamics
        needed = dynamics.mass_matrix @ solution.acceleration + dynamics.bias
        assert np.allclose(result.torque, needed - frame.jacobian[:3].T @ push, atol=1e-6)
        results[friction] = acceleration
    assert np.allclose(results[0.0], results[0.3], atol=1e-4), "friction is compensated"
    held = ghc.Controller(_sliding_arm(kind="point"), settings)
    held.start(replace(state, v=np.zeros(7)))
    assert held.step(replace(state, v=np.zeros(7))).solution.force.shape == (3,)
