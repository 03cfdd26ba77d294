"""Dynamics and frames of the compiled core against Pinocchio, on every robot of the repository."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from model_states import pin_model

from ghc_controller.errors import ConfigurationError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array

ROBOTS = ("kuka_lwr", "icub", "icub_upper_body", "icub_fencer", "humanoid", "all_kinds")
STATES = 20
TOLERANCE = 1e-12  # relative to the largest entry
LWA = pin.LOCAL_WORLD_ALIGNED


def _chain(base: pin.JointModel | None, kinds: list[pin.JointModel]) -> pin.Model:
    """A branch at every second joint, each link with a mass off its axes."""
    rng = np.random.default_rng(11)
    model, parent = pin.Model(), 0
    model.gravity.linear = np.array([0.3, -0.2, -9.0])
    for number, kind in enumerate([kind for kind in (base, *kinds) if kind is not None]):
        placement = pin.SE3.Random() if number else pin.SE3.Identity()
        joint = model.addJoint(parent, kind, placement, f"joint_{number}")
        turn = pin.exp3(rng.uniform(-1.0, 1.0, 3))
        body = pin.Inertia(
            1.0 + number, rng.uniform(-0.3, 0.3, 3), turn @ np.diag([0.2, 0.3, 0.4]) @ turn.T
        )
        model.appendBodyToJoint(joint, body, pin.SE3.Identity())
        model.addBodyFrame(f"link_{number}", joint, pin.SE3.Random(), 0)
        parent = joint if number % 2 else int(model.parents[joint]) or joint
    model.armature = rng.uniform(0.0, 0.5, model.nv)
    return model


def _model(robot: str) -> pin.Model:
    if robot != "all_kinds":
        return pin_model(robot)
    pin.seed(3)
    axis = np.array([0.6, 0.0, -0.8])
    kinds = [
        pin.JointModelRX(),
        pin.JointModelPY(),
        pin.JointModelRevoluteUnaligned(axis),
        pin.JointModelPrismaticUnaligned(axis),
        pin.JointModelHZ(0.2),
        pin.JointModelRZ(),
    ]
    return _chain(pin.JointModelFreeFlyer(), kinds)


def _close(value: Array, wanted: Array) -> None:
    assert np.abs(value - wanted).max() <= TOLERANCE * max(np.abs(wanted).max(), 1.0)


@pytest.mark.parametrize("robot", ROBOTS)
def test_model_terms_equal_those_of_pinocchio(robot: str) -> None:
    """M, h, gravity, center of mass and all frames at random states, also far from the origin."""
    plain, rng = _model(robot), np.random.default_rng(5)
    model, data = RobotModel(plain), plain.createData()
    for state in range(STATES):
        step = rng.uniform(-1.0, 1.0, plain.nv) * (10.0 if state == 0 else 1.0)
        q, v = pin.integrate(plain, pin.neutral(plain), step), rng.uniform(-2.0, 2.0, plain.nv)
        dynamics = model.update(q, v)
        upper = np.triu(pin.crba(plain, data, q))
        _close(dynamics.mass_matrix, upper + np.triu(upper, 1).T)
        assert np.array_equal(dynamics.mass_matrix, dynamics.mass_matrix.T)
        _close(dynamics.bias, pin.nonLinearEffects(plain, data, q, v))
        _close(model.gravity(), pin.computeGeneralizedGravity(plain, data, q))
        pin.centerOfMass(plain, data, q, v, np.zeros(plain.nv))
        _close(model.center_of_mass(), data.com[0])
        _close(model.center_of_mass_velocity(), data.vcom[0])
        _close(model.center_of_mass_drift(), data.acom[0])
        _close(model.center_of_mass_jacobian(), pin.jacobianCenterOfMass(plain, data, q))
        pin.forwardKinematics(plain, data, q, v, np.zeros(plain.nv))
        pin.computeJointJacobians(plain, data, q)
        pin.updateFramePlacements(plain, data)
        _close(model.angular_axes(), data.J[3:])
        for name in model.frame_names:
            frame, terms = plain.getFrameId(name, pin.BODY), model.frame(model.frame_id(name))
            _close(terms.position, data.oMf[frame].translation)
            _close(terms.rotation, data.oMf[frame].rotation)
            _close(terms.jacobian, pin.getFrameJacobian(plain, data, frame, LWA))
            _close(terms.velocity, pin.getFrameVelocity(plain, data, frame, LWA).vector)
            drift = pin.getFrameClassicalAcceleration(plain, data, frame, LWA).vector
            _close(terms.drift, drift)


def test_a_joint_with_another_motion_is_rejected_by_its_kind() -> None:
    """One coordinate is not enough: it has to be a turn about or a slide along one axis."""
    two = pin.JointModelComposite(pin.JointModelRX(), pin.SE3.Random())
    with pytest.raises(ConfigurationError, match=r"'joint_0' is a JointModelComposite"):
        RobotModel(_chain(None, [two]))
