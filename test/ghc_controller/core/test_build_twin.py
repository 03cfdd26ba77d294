"""Task rows and joint limits of the compiled core against the twin in NumPy and Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from model_states import make_model, pin_model, random_state
from twin_of_build import TwinJoint, TwinKinematics, contact_rows, law, pose_error

from ghc_controller.constraints import (
    ConstraintSet,
    JointPositionLimit,
    JointVelocityLimit,
    TorqueCenter,
    TorqueLimit,
    TorqueRateLimit,
)
from ghc_controller.constraints.planned_jerk import PlannedJerk
from ghc_controller.contacts import BoundsInForce, ContactSet
from ghc_controller.contacts.contact import Contact, OnStale, contact_axes
from ghc_controller.contacts.surface import SurfaceContact
from ghc_controller.model.frames import FrameTerms
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.tasks.center_of_mass import CenterOfMassTask
from ghc_controller.tasks.frame import FrameOrientationTask, FramePoseTask, FramePositionTask
from ghc_controller.tasks.joint_limit import JointLimitTask
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.tasks.relative_frame import RelativePoseTask
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget

TOLERANCE = 1e-12  # relative to the largest entry, at least 1
GAINS = (30.0, 11.0)
DT = 1e-3  # [s]


def _close(value: Array, wanted: Array) -> None:
    assert np.abs(value - wanted).max() <= TOLERANCE * max(np.abs(wanted).max(), 1.0)


class PlainPosition(FramePositionTask):
    """Brings a `measure` of its own, like a task of another package."""

    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:
        """As its base, with twice the error."""
        super().measure(model, reference, out)
        out.error *= 2.0


class PluggedContact(Contact):
    """Brings its own motion rows, like a contact of another package."""

    def write_motion(self, frame: FrameTerms, jacobian: Array, target: Array) -> None:
        """Those of its base."""
        super().write_motion(frame, jacobian, target)


@pytest.mark.parametrize("robot", ["kuka_lwr", "icub", "humanoid"])
@pytest.mark.parametrize("seed", range(3))
def test_a_stack_of_all_standard_kinds_has_the_rows_of_the_twin(robot: str, seed: int) -> None:
    """Error, Jacobian, drift and target of every row, with references that move."""
    rng = np.random.default_rng(seed)
    model, plain, state = make_model(robot), pin_model(robot), random_state(robot, rng)
    twin = TwinKinematics(plain, state.q, state.v)
    names = model.frame_names
    hand, base = names[-1], names[len(names) // 2]
    joints = (model.joint_names[2], model.joint_names[0])
    tasks = [
        FramePositionTask("position", model, hand, *GAINS, axes=("z", "x")),
        FrameOrientationTask("orientation", model, base, *GAINS),
        FramePoseTask("pose", model, hand, *GAINS),
        RelativePoseTask("relative", model, hand, base, *GAINS),
        CenterOfMassTask("center", model, *GAINS, axes=("y", "z")),
        PostureTask("posture", model, *GAINS, joints=joints),
        JointLimitTask("limit", model, *GAINS, margin=0.1),
        PlainPosition("plugged", model, hand, *GAINS),
    ]
    targets = []
    for task in tasks:
        position = rng.uniform(-1.0, 1.0, task.default_target(model).position.shape)
        position[-4:] /= np.linalg.norm(position[-4:]) if len(position) in (4, 7) else 1.0
        targets.append(TaskTarget(position, *rng.uniform(-1.0, 1.0, (2, task.reference_size))))
    stack = TaskStack(tasks, model.nv)
    model.update(state.q, state.v)
    for _ in range(2):  # the second time nothing is new
        stack.update(model, state, targets)

    def quaternion(given: Array) -> Array:
        return np.concatenate([np.zeros(3), given])

    p, R, J, _, drift = twin.frame(hand)
    pb, Rb, Jb, _, drift_b = twin.frame(base)
    ps, Rs, Js, drift_s = twin.seen(hand, base)
    c, Jc, drift_c = twin.center()
    u = model.nv - model.na
    rows, eye = np.array([model.joint_index(joint) for joint in joints]), np.eye(model.nv)
    q = state.q[-model.na :]
    lower, upper = model.position_lower + 0.1, model.position_upper - 0.1
    beyond = np.clip(q, lower, upper) - q
    wanted = [
        (targets[0].position - p[[2, 0]], J[[2, 0]], drift[[2, 0]]),
        (pose_error(quaternion(targets[1].position), pb, Rb)[3:], Jb[3:], drift_b[3:]),
        (pose_error(targets[2].position, p, R), J, drift),
        (pose_error(targets[3].position, ps, Rs), Js, drift_s),
        (targets[4].position - c[1:], Jc[1:], drift_c[1:]),
        (targets[5].position - q[rows], eye[u + rows], np.zeros(2)),
        (beyond, eye[u:] * (beyond != 0.0)[:, None], np.zeros(model.na)),
        (2.0 * (targets[7].position - p), J[:3], drift[:3]),
    ]
    for i, (error, jacobian, change) in enumerate(wanted):
        own = stack.rows.block(int(stack.starts[i]), int(stack.starts[i + 1]))
        motion = np.stack([targets[i].velocity, targets[i].acceleration])
        if i == 6:
            motion = 0.0 * motion
        _close(own.error, error)
        _close(own.jacobian, jacobian)
        _close(own.drift, change)
        _close(own.target, law(error, jacobian, change, state.v, motion, GAINS))


@pytest.mark.parametrize("robot", ["kuka_lwr", "humanoid"])
def test_joint_limits_are_those_of_the_twin(robot: str) -> None:
    """Position, velocity, torque and rate with a planned jerk, inside and beyond their limits."""
    rng = np.random.default_rng(2)
    model, plain = make_model(robot), pin_model(robot)
    a, u = model.na, model.nv - model.na
    data = plain.createData()
    for _ in range(40):
        q = pin.integrate(plain, pin.neutral(plain), rng.uniform(-1.0, 1.0, plain.nv))
        v = rng.uniform(-2.0, 2.0, plain.nv)
        low, high = q[-a:] - 10.0 ** rng.uniform(-4, 1, a), q[-a:] + 10.0 ** rng.uniform(-4, 1, a)
        low += 0.02 * (rng.random(a) < 0.2)  # some joints are beyond it
        speed, brake = rng.uniform(0.5, 3.0, a), rng.uniform(2.0, 20.0, a)
        limit, rate = rng.uniform(50.0, 100.0, a), rng.uniform(200.0, 2000.0, a)
        previous = rng.uniform(-60.0, 60.0, a)
        planned = PlannedJerk(rate, a)
        boxes = ConstraintSet(
            [
                TorqueLimit(limit, a, TorqueCenter.GRAVITY),
                TorqueRateLimit(rate, a),
                JointPositionLimit(low, high, brake),
                JointVelocityLimit(speed, a, 0.05),
            ],
            model,
            planned,
        ).update(model, model.update(q, v), RobotState(0.0, q, v), previous, DT)
        center = pin.computeGeneralizedGravity(plain, data, q)[u:]
        _close(boxes.torque.hard.lower, center - limit)
        _close(boxes.torque.hard.upper, center + limit)
        least, most = center - limit, center + limit
        nearest = np.clip(np.stack([previous - rate * DT, previous + rate * DT]), least, most)
        _close(boxes.torque.bounds.lower, nearest[0])
        _close(boxes.torque.bounds.upper, nearest[1])
        for i in range(a):
            limits = (low[i], high[i], speed[i], brake[i], 8.0, planned.jerk[i], DT, 0.05)
            joint = TwinJoint(q[-a + i], v[u + i], *limits)
            lower, upper = joint.position()
            least_v, most_v = joint.velocity()
            if least_v > upper:  # what misses gives way
                lower = upper
            elif most_v < lower:
                upper = lower
            else:
                lower, upper = max(lower, least_v), min(upper, most_v)
            _close(boxes.acceleration.bounds.lower[u + i : u + i + 1], np.array([lower]))
            _close(boxes.acceleration.bounds.upper[u + i : u + i + 1], np.array([upper]))
        assert np.isinf(boxes.acceleration.bounds.upper[:u]).all()


@pytest.mark.parametrize("seed", range(3))
def test_contact_rows_are_those_of_the_twin(seed: int) -> None:
    """Points with friction, without, and a surface, beside one that Python writes."""
    rng = np.random.default_rng(seed)
    model, plain = make_model("humanoid"), pin_model("humanoid")
    state = random_state("humanoid", rng)
    twin = TwinKinematics(plain, state.q, state.v)
    names = model.frame_names[-4:]
    kinds = (Contact, Contact, SurfaceContact, PluggedContact)
    contacts = [
        kind(
            name,
            model.frame_id(name),
            rng.uniform(-0.1, 0.1, (4, 3)),
            contact_axes(rng.uniform(0.1, 1.0, 3), name),
            friction,
            0.0,
            100.0,
            True,
            OnStale.HOLD,
        )
        for kind, name, friction in zip(kinds, names, (0.5, 0.0, 0.5, 0.5), strict=True)
    ]
    model.update(state.q, state.v)
    bounds = BoundsInForce(contacts).at(0.0)
    rows = ContactSet(contacts).rows(model, bounds, ReferenceSchedule([]), 0.0)
    assert rows is not None
    forces, jacobians, targets = [], [], []
    for contact in contacts:
        terms = twin.frame(contact.name)
        axes = contact.axes if contact.friction > 0.0 else contact.axes[2:]
        force, target = contact_rows(terms, contact.points, axes, 20.0)
        forces.append(force)
        whole = isinstance(contact, SurfaceContact)
        jacobians.append(terms[2] if whole else force)
        targets.append(-terms[4] - 20.0 * terms[3] if whole else target)
    _close(rows.force_jacobian, np.vstack(forces))
    _close(rows.jacobian, np.vstack(jacobians))
    _close(rows.drift_target, np.concatenate(targets))
