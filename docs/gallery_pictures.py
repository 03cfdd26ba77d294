"""Pictures of docs/robots.md: `python docs/gallery_pictures.py [names]` draws them off-screen."""

from __future__ import annotations

import dataclasses
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from PIL import Image  # noqa: E402

from benchmarks.models import STUDY_ROBOTS, install_model, install_study_model  # noqa: E402
from ghc_sim_bridge import Simulator, load_scene  # noqa: E402
from ghc_sim_bridge.scene.values import SceneDescription  # noqa: E402
from ghc_sim_bridge.simulation.rendering import Renderer  # noqa: E402

FOLDER = ROOT / "docs" / "figures" / "robots"
SIZE = (960, 720)  # [pixel] drawn; a quarter of it is kept
SCENES: dict[str, str | Path] = {
    "kuka_lwr": "kuka_lwr",
    "kuka_lwr_push": "kuka_lwr_push",
    "panda": STUDY_ROBOTS / "panda_scene.yaml",
    "ur5": STUDY_ROBOTS / "ur5_scene.yaml",
    "icub": "icub_standing",
    "icub_seated": "icub_seated",
    "icub_table": "icub_table",
    "icub_upper_body": "icub_upper_body",
    "icub_fencer": "icub_fencer",
}
# A camera that is nearer than that of the scene, and what it looks at [m].
VIEWS: dict[str, tuple[float, tuple[float, float, float]]] = {
    "kuka_lwr": (1.5, (0.15, 0.0, 0.45)),
    "kuka_lwr_push": (2.0, (0.3, 0.0, 0.3)),
    "panda": (1.5, (0.2, 0.0, 0.4)),
    "ur5": (1.2, (0.3, 0.0, 0.3)),
    "icub": (1.6, (0.05, 0.0, 0.5)),
    "icub_seated": (1.6, (0.05, 0.0, 0.4)),
    "icub_table": (1.7, (0.15, 0.0, 0.5)),
    "icub_upper_body": (1.4, (0.05, 0.0, 0.15)),
    "icub_fencer": (1.6, (0.05, 0.0, 0.5)),
}


def drawable(scene: SceneDescription, folder: Path) -> SceneDescription:
    """The scene with meshes that MuJoCo reads: it has no decoder for Collada (.dae).

    The packages of these robots have an STL of each collision shape beside it.
    """
    text = scene.urdf.read_text(encoding="utf-8")
    if ".dae" not in text:
        return scene
    text = text.replace("/visual/", "/collision/").replace(".dae", ".stl")
    share = next(Path(sys.prefix).glob("lib/python3*/site-packages/cmeel.prefix/share"))
    copy = folder / scene.urdf.name
    copy.write_text(text.replace("package://", f"{share}/"), encoding="utf-8")
    return dataclasses.replace(scene, urdf=copy)


def draw(name: str) -> None:
    """Draw a robot in its scene, at its start."""
    scene = load_scene(SCENES[name])
    simulator = Simulator(scene)
    distance, look_at = VIEWS[name]
    camera = dataclasses.replace(scene.camera, distance=distance, look_at=look_at)
    with tempfile.TemporaryDirectory() as folder:
        drawn = drawable(scene, Path(folder))
        with Renderer(drawn, SIZE, simulator.joint_names) as renderer:
            picture = Image.fromarray(renderer.draw(simulator.state().q, camera=camera))
    small = picture.resize((SIZE[0] // 2, SIZE[1] // 2), Image.Resampling.LANCZOS)
    FOLDER.mkdir(parents=True, exist_ok=True)
    small.quantize(128).save(FOLDER / f"{name}.png", optimize=True)


if __name__ == "__main__":
    install_model("icub-models")
    install_study_model("example-robot-data")
    for name in sys.argv[1:] or SCENES:
        draw(name)
