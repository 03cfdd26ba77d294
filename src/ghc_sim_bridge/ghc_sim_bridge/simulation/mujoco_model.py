"""From a scene description to a MuJoCo model: the URDF, plus what a URDF cannot say.

Mass matrix, bias and Jacobians of the model are those of the URDF: whatever MuJoCo reads into
or adds to a URDF (joint damping, inertia of shapes, balanced inertias) is switched off.
"""

from __future__ import annotations

import mujoco
import numpy as np

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_sim_bridge.scene.values import Contact, SceneDescription
from ghc_sim_bridge.simulation.surroundings import (
    ROBOT_BIT,
    WORLD_BIT,
    add_light_and_ground,
    add_surface,
)
from ghc_sim_bridge.simulation.urdf_for_mujoco import WORLD_LINK, for_mujoco

CONTACT_GAP = 1e-3  # [m] closer than this a point is listed as touching; force only from 0 on


def build_model(
    scene: SceneDescription, physics_dt: float, shapes: bool = False
) -> mujoco.MjModel:
    """Compile the scene; `physics_dt` [s] is the step of the integrator.

    Every link of the URDF becomes a site of its name. The robot's shapes are for the eye and only
    there when asked for: contacts are spheres of the scene.

    Raises ConfigurationError when the URDF cannot be used, UnknownName for a contact's frame.
    """
    spec = _read_urdf(scene, shapes)
    _set_physics(spec, scene, physics_dt)
    _strip_robot(spec, scene.end_stops)
    frames = _add_frame_sites(spec)
    for contact in scene.contacts:
        _add_contact(spec, contact, frames)
    for surface in scene.surfaces:
        add_surface(spec, surface)
    add_light_and_ground(spec, scene.camera)
    try:
        return spec.compile()
    except ValueError as error:
        raise _refused(scene, error) from error


def joints_of(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the joints of one coordinate, in MuJoCo's order."""
    joints = (model.joint(k) for k in range(model.njnt))
    return tuple(joint.name for joint in joints if joint.type[0] != mujoco.mjtJoint.mjJNT_FREE)


def base_frame_of(model: mujoco.MjModel) -> str:
    """Name of the link that floats; empty when the base is fixed."""
    for k in range(model.njnt):
        if model.jnt_type[k] == mujoco.mjtJoint.mjJNT_FREE:
            return str(model.body(model.jnt_bodyid[k]).name)
    return ""


def contact_geom_names(contact: Contact) -> tuple[str, ...]:
    """Names of the contact's spheres in the model."""
    return tuple(f"contact/{contact.name}/{k}" for k in range(len(contact.centers)))


def _read_urdf(scene: SceneDescription, shapes: bool) -> mujoco.MjSpec:
    urdf = for_mujoco(scene.urdf, scene.robot.floating_base, shapes)
    try:
        return mujoco.MjSpec.from_string(urdf)
    except ValueError as error:
        raise _refused(scene, error) from error


def _refused(scene: SceneDescription, error: ValueError) -> ConfigurationError:
    reason = " ".join(str(error).split())
    return ConfigurationError(f"{scene.urdf}: MuJoCo rejects it: {reason}")


def _set_physics(spec: mujoco.MjSpec, scene: SceneDescription, physics_dt: float) -> None:
    option = spec.option
    option.timestep = physics_dt
    option.gravity = list(scene.gravity)
    # Without damping this is the semi-implicit Euler step v+ = v + dt M^-1 (tau - h): what the
    # controller asks for is what happens over a period, to rounding.
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 10.0  # friction as hard as the normal direction: little creep
    option.tolerance = 1e-12
    option.iterations = 50
    # A diverged state is an error here, not a silent jump back to the reference posture.
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    spec.compiler.fusestatic = True


def _strip_robot(spec: mujoco.MjSpec, end_stops: bool) -> None:
    for joint in spec.joints:
        joint.damping = np.zeros_like(np.array(joint.damping))
        joint.stiffness = np.zeros_like(np.array(joint.stiffness))
        joint.frictionloss = 0.0
        joint.armature = 0.0
        if not end_stops:
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
        # The URDF's effort became a clamp on actuator forces; limits are the bridge's business.
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0
        geom.mass = 0.0


def _add_frame_sites(spec: mujoco.MjSpec) -> tuple[str, ...]:
    none = ("", spec.worldbody.name, WORLD_LINK)
    frames = [body for body in spec.bodies if body.name not in none]
    for body in frames:
        body.add_site(name=body.name, group=5)
    return tuple(body.name for body in frames)


def _add_contact(spec: mujoco.MjSpec, contact: Contact, frames: tuple[str, ...]) -> None:
    if contact.frame not in frames:
        raise UnknownName(f"frame of contact '{contact.name}'", contact.frame, frames)
    body = spec.body(contact.frame)
    for name, center in zip(contact_geom_names(contact), contact.centers, strict=True):
        body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[contact.radius, 0.0, 0.0],
            pos=list(center),
            mass=0.0,
            group=3,  # not drawn: the URDF has the shapes for the eye
            contype=ROBOT_BIT,
            conaffinity=WORLD_BIT,
            condim=3 if contact.friction > 0.0 else 1,
            friction=[contact.friction, 0.0, 0.0],
            solref=[contact.time_constant, contact.damping_ratio],
            gap=CONTACT_GAP,
            priority=1,  # the contact's friction and softness hold, whatever it touches
        )
