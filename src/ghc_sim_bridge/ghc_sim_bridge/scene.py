"""From a scene description to a MuJoCo model: the URDF, plus what a URDF cannot say.

Mass matrix, bias and Jacobians of the model are those of the URDF: whatever MuJoCo reads into
or adds to a URDF (joint damping, inertia of shapes, balanced inertias) is switched off.
"""

from __future__ import annotations

import re

import mujoco
import numpy as np

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_sim_bridge.scene_description import Contact, SceneDescription, Surface

# Contact filter: robot spheres carry bit 1 and feel bit 2, surfaces the other way round, so that
# the robot touches its surroundings and never itself.
ROBOT_BIT, WORLD_BIT = 1, 2

# Compiler settings have to be there when the URDF is read. Static bodies are fused only later,
# after their frames became sites; shapes are kept as they are for the pictures.
_COMPILER = (
    '<mujoco><compiler fusestatic="false" discardvisual="false" balanceinertia="false" '
    'boundmass="0" boundinertia="0" strippath="false"/></mujoco>'
)


def build_model(scene: SceneDescription, physics_dt: float) -> mujoco.MjModel:
    """Compile the scene; `physics_dt` [s] is the step of the integrator.

    Every link of the URDF without a joint of its own (a frame) becomes a site of its name.

    Raises ConfigurationError when the URDF cannot be used, UnknownName for a contact's frame.
    """
    spec = _read_urdf(scene)
    _set_physics(spec, scene, physics_dt)
    _strip_robot(spec)
    frames = _add_frame_sites(spec)
    for contact in scene.contacts:
        _add_contact(spec, contact, frames)
    for surface in scene.surfaces:
        _add_surface(spec, surface)
    _dress(spec, scene)
    try:
        return spec.compile()
    except ValueError as error:
        raise _refused(scene, error) from error


def contact_geom_names(contact: Contact) -> tuple[str, ...]:
    """Names of the contact's spheres in the model."""
    return tuple(f"contact/{contact.name}/{k}" for k in range(len(contact.points)))


def _read_urdf(scene: SceneDescription) -> mujoco.MjSpec:
    try:
        text = scene.urdf.read_text(encoding="utf-8").replace("package://", "")
    except OSError as error:
        raise ConfigurationError(f"{scene.urdf}: cannot be read: {error.strerror}") from error
    text, found = re.subn(r"(<robot\b[^>]*>)", rf"\1{_COMPILER}", text, count=1)
    if not found:
        raise ConfigurationError(f"{scene.urdf}: not a URDF, it has no <robot> element")
    try:
        return mujoco.MjSpec.from_string(text)
    except ValueError as error:
        raise _refused(scene, error) from error


def _refused(scene: SceneDescription, error: ValueError) -> ConfigurationError:
    reason = " ".join(str(error).split())
    return ConfigurationError(f"{scene.urdf}: MuJoCo refuses it: {reason}")


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


def _strip_robot(spec: mujoco.MjSpec) -> None:
    for joint in spec.joints:
        joint.damping = np.zeros_like(np.array(joint.damping))
        joint.stiffness = np.zeros_like(np.array(joint.stiffness))
        joint.frictionloss = 0.0
        joint.armature = 0.0
        # The URDF's effort became a clamp on actuator forces; limits are the bridge's business.
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0
        geom.mass = 0.0


def _add_frame_sites(spec: mujoco.MjSpec) -> tuple[str, ...]:
    frames = [b for b in spec.bodies if b is not spec.worldbody and b.name and not b.joints]
    for body in frames:
        body.add_site(name=body.name, group=5)
    return tuple(body.name for body in frames)


def _add_contact(spec: mujoco.MjSpec, contact: Contact, frames: tuple[str, ...]) -> None:
    if contact.frame not in frames:
        raise UnknownName(f"frame of contact '{contact.name}'", contact.frame, frames)
    body = spec.body(contact.frame)
    for name, point in zip(contact_geom_names(contact), contact.points, strict=True):
        body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[contact.radius, 0.0, 0.0],
            pos=list(point),
            mass=0.0,
            group=3,  # not drawn: the URDF has the shapes for the eye
            contype=ROBOT_BIT,
            conaffinity=WORLD_BIT,
            condim=3 if contact.friction > 0.0 else 1,
            friction=[contact.friction, 0.0, 0.0],
            solref=[contact.time_constant, contact.damping_ratio],
            priority=1,  # the contact's friction and softness hold, whatever it touches
        )


def _add_surface(spec: mujoco.MjSpec, surface: Surface) -> None:
    x, y, z = surface.top
    length, width, height = surface.size
    plane = surface.kind == "plane"
    spec.worldbody.add_geom(
        name=surface.name,
        type=mujoco.mjtGeom.mjGEOM_PLANE if plane else mujoco.mjtGeom.mjGEOM_BOX,
        size=[length / 2, width / 2, 0.05 if plane else height / 2],
        pos=[x, y, z if plane else z - height / 2],
        material="ground" if plane else "",
        rgba=list(surface.colour),
        contype=WORLD_BIT if surface.touches else 0,
        conaffinity=ROBOT_BIT if surface.touches else 0,
    )


def _dress(spec: mujoco.MjSpec, scene: SceneDescription) -> None:
    """Light, sky and ground for the pictures; nothing of it has a mass."""
    spec.visual.map.znear, spec.visual.map.zfar = 0.05, 30.0
    spec.visual.map.haze, spec.visual.map.shadowclip = 0.4, 2.0
    spec.visual.rgba.haze = [0.90, 0.93, 0.97, 1.0]
    spec.visual.quality.shadowsize = 4096
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1440
    spec.stat.extent, spec.stat.center = 1.0, list(scene.camera.look_at)
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.diffuse = [0.35, 0.35, 0.35]
    spec.visual.headlight.specular = [0.1, 0.1, 0.1]
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[1.0, 1.0, 1.0],
        rgb2=[0.82, 0.87, 0.93],
        width=256,
        height=1536,
    )
    spec.add_texture(
        name="ground",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.90, 0.91, 0.93],
        rgb2=[0.84, 0.86, 0.89],
        width=256,
        height=256,
    )
    textures = [""] * int(mujoco.mjtTextureRole.mjNTEXROLE)
    textures[int(mujoco.mjtTextureRole.mjTEXROLE_RGB)] = "ground"
    spec.add_material(
        name="ground", textures=textures, texrepeat=[2.0, 2.0], texuniform=True, reflectance=0.08
    )
    spec.worldbody.add_light(
        pos=[1.5, -1.5, 3.5],
        dir=[-0.35, 0.4, -1.0],
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        diffuse=[0.55, 0.55, 0.55],
        specular=[0.25, 0.25, 0.25],
        castshadow=True,
    )
