"""Pictures: where the machine has off-screen OpenGL they show the arm, else one clear error."""

from __future__ import annotations

import ctypes.util
from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import fromstring

import numpy as np
import pytest
from PIL import Image

from ghc_sim_bridge.errors import RenderingUnavailable
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.simulation.rendering import Marker, Renderer, filmstrip, save_png
from ghc_sim_bridge.simulation.urdf_for_mujoco import for_mujoco

SIZE = (320, 240)


@pytest.fixture
def renderer() -> Iterator[Renderer | None]:
    """A renderer, or None where there is no OpenGL; then the error has been checked."""
    try:
        opened = Renderer(load_scene("kuka_lwr"), SIZE)
    except RenderingUnavailable as error:
        assert "libegl1" in str(error) and "\n" not in str(error)
        yield None
        return
    with opened:
        yield opened


def count(picture: np.ndarray, colour: str) -> int:
    """Pixels that are clearly of a color."""
    red, green, blue = picture.astype(int).transpose(2, 0, 1)
    strong = {"orange": (red > green + 60) & (green > blue), "blue": blue > red + 80}
    return int(strong[colour].sum())


def test_the_picture_shows_the_orange_arm(renderer: Renderer | None) -> None:
    if renderer is None:
        return
    picture = renderer.draw(np.zeros(7))
    assert picture.shape == (240, 320, 3) and picture.dtype == np.uint8
    assert 0.01 < count(picture, "orange") / picture.size * 3 < 0.3
    assert picture.std() > 20.0


def test_another_posture_is_another_picture_and_the_same_one_the_same(
    renderer: Renderer | None,
) -> None:
    if renderer is None:
        return
    straight, bent = renderer.draw(np.zeros(7)), renderer.draw(np.full(7, 0.8))
    assert np.abs(straight.astype(int) - bent).mean() > 1.0
    again = renderer.draw(np.zeros(7))
    assert np.abs(straight.astype(int) - again).mean() < 0.01  # shades of a few pixels


def test_markers_are_drawn_where_nothing_hides_them(renderer: Renderer | None) -> None:
    if renderer is None:
        return
    marker = Marker((0.4, 0.0, 0.3), radius=0.05, colour=(0.0, 0.1, 1.0, 1.0))
    assert count(renderer.draw(np.zeros(7)), "blue") == 0
    assert count(renderer.draw(np.zeros(7), [marker]), "blue") > 20
    assert count(renderer.draw(np.zeros(7)), "blue") == 0


def test_a_strip_holds_its_pictures_side_by_side_and_is_saved_as_png(tmp_path: Path) -> None:
    pictures = [np.full((20, 30, 3), shade, dtype=np.uint8) for shade in (10, 90, 170)]
    strip = filmstrip(pictures)
    assert strip.shape == (20, 3 * 30 + 2 * 8, 3)
    assert [int(strip[0, x, 0]) for x in (0, 30, 38, 76)] == [10, 255, 90, 170]
    assert filmstrip(pictures, columns=2).shape == (48, 68, 3)
    file = tmp_path / "new" / "strip.png"
    save_png(strip, file)
    assert np.array_equal(np.asarray(Image.open(file)), strip)


def test_without_a_library_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(ctypes.util, "find_library", lambda _: None)
    with pytest.raises(RenderingUnavailable) as error:
        Renderer(load_scene("kuka_lwr"), SIZE)
    assert str(error.value) == (
        "no off-screen OpenGL: neither libEGL nor libOSMesa is installed; on Debian and Ubuntu "
        "install libegl1 libegl-mesa0 libgl1-mesa-dri (EGL) or libosmesa6 (OSMesa)"
    )


def test_a_backend_that_does_not_start_is_one_clear_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(name: str) -> None:
        raise ImportError(f"{name}: no\ndriver")

    monkeypatch.setattr("ghc_sim_bridge.simulation.rendering.import_module", refuse)
    monkeypatch.setenv("MUJOCO_GL", "egl")
    with pytest.raises(RenderingUnavailable, match=r"egl does not start \(mujoco.egl: no"):
        Renderer(load_scene("kuka_lwr"), SIZE)


def test_meshes_that_mujoco_cannot_read_give_way_to_collision_shapes(tmp_path: Path) -> None:
    """Collada: the picture shows the collision shapes, and none where there are none."""
    urdf = tmp_path / "arm.urdf"
    mesh = '<visual><geometry><mesh filename="a.dae"/></geometry></visual>'
    ball = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
    bodies = {"base": mesh + ball, "tip": mesh, "end": mesh.replace("dae", "STL") + ball}
    links = "".join(f'<link name="{name}">{shapes}</link>' for name, shapes in bodies.items())
    urdf.write_text(f'<robot name="arm">{links}</robot>', encoding="utf-8")
    kept = fromstring(for_mujoco(urdf, False, True))
    shapes = {link.get("name"): [shape.tag for shape in link] for link in kept.iter("link")}
    assert shapes == {"base": ["collision"], "tip": [], "end": ["visual"]}
