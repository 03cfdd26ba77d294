"""What stands around the robot in MuJoCo: surfaces to touch, and light to see by."""

from __future__ import annotations

import mujoco

from ghc_sim_bridge.scene.values import Camera, Surface

# Contact filter: robot spheres carry bit 1 and feel bit 2, surfaces the other way round, so that
# the robot touches its environment and never itself.
ROBOT_BIT, WORLD_BIT = 1, 2


def add_surface(spec: mujoco.MjSpec, surface: Surface) -> None:
    """A plane or box that stands still, and that contacts feel unless it is for the eye."""
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


def add_light_and_ground(spec: mujoco.MjSpec, camera: Camera) -> None:
    """Light, sky and the look of planes, for the pictures."""
    spec.visual.map.znear, spec.visual.map.zfar = 0.05, 30.0
    spec.visual.map.haze, spec.visual.map.shadowclip = 0.4, 2.0
    spec.visual.rgba.haze = [0.90, 0.93, 0.97, 1.0]
    spec.visual.quality.shadowsize = 4096
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1440
    spec.stat.extent, spec.stat.center = 1.0, list(camera.look_at)
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
