"""Off-screen pictures of a scene: one frame, or a strip of frames for a report.

MuJoCo picks its OpenGL backend when it is imported and defaults to a window system. Here the
backend is opened directly, so that no environment variable has to be set before any import:
EGL where its library is, else OSMesa; MUJOCO_GL overrules both.
"""

from __future__ import annotations

import ctypes.util
import os
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from ghc_sim_bridge.errors import RenderingUnavailable
from ghc_sim_bridge.scene.values import Camera, SceneDescription
from ghc_sim_bridge.simulation.coordinates import FixedBase, FloatingBase
from ghc_sim_bridge.simulation.joint_map import JointMap
from ghc_sim_bridge.simulation.mujoco_model import build_model, joints_of

Picture = NDArray[np.uint8]  # (height, width, 3)

LIBRARIES = {"egl": "EGL", "osmesa": "OSMesa"}
PACKAGES = "libegl1 libegl-mesa0 libgl1-mesa-dri (EGL) or libosmesa6 (OSMesa)"
LARGEST_SIZE = (1920, 1440)  # [pixel] of the off-screen buffer, see mujoco_model.py
GAP = 8  # [pixel] between the frames of a strip


@dataclass(frozen=True)
class Marker:
    """A ball in the picture: a target, or a point of a path."""

    position: tuple[float, float, float]  # [m] world
    radius: float = 0.02  # [m]
    colour: tuple[float, float, float, float] = (0.1, 0.45, 0.9, 0.9)


class Renderer:
    """Draws a scene in any posture, without a window; close it or use it in a `with`."""

    def __init__(
        self,
        scene: SceneDescription,
        size: tuple[int, int] = (960, 720),
        joint_names: Sequence[str] | None = None,
    ) -> None:
        """Open an off-screen context for pictures of `size` (width, height) [pixel].

        Raises RenderingUnavailable when the machine has no OpenGL that works without a window.
        """
        self.size = (min(size[0], LARGEST_SIZE[0]), min(size[1], LARGEST_SIZE[1]))
        self._camera = _camera(scene.camera)
        self._model = build_model(scene, 1e-3, shapes=True)
        self._data = mujoco.MjData(self._model)
        simulated = joints_of(self._model)
        joints = JointMap(simulated if joint_names is None else joint_names, simulated)
        self._coordinates = FixedBase(joints) if scene.base is None else FloatingBase(joints)
        self._option = mujoco.MjvOption()
        self._scene = mujoco.MjvScene(self._model, maxgeom=4000)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_HAZE] = True
        self._context = _open_context(self.size)
        self._gpu = mujoco.MjrContext(self._model, mujoco.mjtFontScale.mjFONTSCALE_150.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._gpu)

    def draw(
        self, q: ArrayLike, markers: Sequence[Marker] = (), camera: Camera | None = None
    ) -> Picture:
        """Picture of the robot at q (nq,), seen by the scene's camera or another."""
        configuration = np.array(q, dtype=float)
        self._data.qpos[:] = self._coordinates.configuration_to_simulator(configuration)
        mujoco.mj_forward(self._model, self._data)
        mujoco.mjv_updateScene(
            self._model,
            self._data,
            self._option,
            None,
            self._camera if camera is None else _camera(camera),
            mujoco.mjtCatBit.mjCAT_ALL.value,
            self._scene,
        )
        for marker in markers:
            self._add(marker)
        viewport = mujoco.MjrRect(0, 0, *self.size)
        mujoco.mjr_render(viewport, self._scene, self._gpu)
        picture = np.empty((self.size[1], self.size[0], 3), dtype=np.uint8)
        mujoco.mjr_readPixels(picture, None, viewport, self._gpu)
        return np.flipud(picture)

    def close(self) -> None:
        """Give the off-screen context back."""
        self._gpu.free()
        self._context.free()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _add(self, marker: Marker) -> None:
        if self._scene.ngeom >= self._scene.maxgeom:
            return
        mujoco.mjv_initGeom(
            self._scene.geoms[self._scene.ngeom],
            mujoco.mjtGeom.mjGEOM_SPHERE,
            np.full(3, marker.radius),
            np.array(marker.position, dtype=float),
            np.eye(3).ravel(),
            np.array(marker.colour, dtype=np.float32),
        )
        self._scene.ngeom += 1


def filmstrip(pictures: Sequence[Picture], columns: int | None = None) -> Picture:
    """Pictures of one size side by side, `columns` in a row, on white."""
    height, width, _ = pictures[0].shape
    columns = len(pictures) if columns is None else columns
    rows = -(-len(pictures) // columns)
    strip = np.full(
        (rows * (height + GAP) - GAP, columns * (width + GAP) - GAP, 3), 255, dtype=np.uint8
    )
    for k, picture in enumerate(pictures):
        top, left = k // columns * (height + GAP), k % columns * (width + GAP)
        strip[top : top + height, left : left + width] = picture
    return strip


def save_png(picture: Picture, file: Path) -> None:
    """Write a picture, creating the folder."""
    file.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(picture).save(file, optimize=True)


def _camera(camera: Camera) -> mujoco.MjvCamera:
    view = mujoco.MjvCamera()
    view.lookat[:] = camera.look_at
    view.distance, view.azimuth, view.elevation = (
        camera.distance,
        camera.azimuth,
        camera.elevation,
    )
    return view


def _open_context(size: tuple[int, int]) -> Any:
    backend = os.environ.get("MUJOCO_GL", "").lower()
    if backend not in LIBRARIES:
        found = [name for name, lib in LIBRARIES.items() if ctypes.util.find_library(lib)]
        if not found:
            raise RenderingUnavailable(
                "no off-screen OpenGL: neither libEGL nor libOSMesa is installed; "
                f"on Debian and Ubuntu install {PACKAGES}"
            )
        backend = found[0]
    try:
        context = import_module(f"mujoco.{backend}").GLContext(*size)
        context.make_current()
    except Exception as error:  # the bindings raise whatever the driver's loader trips over
        reason = " ".join(str(error).split()) or type(error).__name__
        raise RenderingUnavailable(
            f"off-screen OpenGL by {backend} does not start ({reason}); "
            f"on Debian and Ubuntu install {PACKAGES}"
        ) from error
    return context
