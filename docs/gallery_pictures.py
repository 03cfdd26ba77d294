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
from benchmarks.users.new_robots import make_files  # noqa: E402
from ghc_sim_bridge import Simulator, load_scene  # noqa: E402
from ghc_sim_bridge.simulation.rendering import Renderer  # noqa: E402

FOLDER = ROOT / "docs" / "figures" / "robots"
SIZE = (960, 720)  # [pixel] drawn; a quarter of it is kept
SCENES: dict[str, str | Path] = {
    "kuka_lwr": "kuka_lwr",
    "kuka_lwr_push": "kuka_lwr_push",
    "two_arms": "two_arms",
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
    "two_arms": (2.0, (0.2, 0.0, 0.42)),
    "panda": (1.5, (0.2, 0.0, 0.4)),
    "ur5": (1.2, (0.3, 0.0, 0.3)),
    "icub": (1.6, (0.05, 0.0, 0.5)),
    "icub_seated": (1.6, (0.05, 0.0, 0.4)),
    "icub_table": (1.7, (0.15, 0.0, 0.5)),
    "icub_upper_body": (1.4, (0.05, 0.0, 0.15)),
    "icub_fencer": (1.6, (0.05, 0.0, 0.5)),
}


# What `new_robot` makes of a URDF: [-] of the distance in its own scene.
CLOSER = {"go2": 1.0, "solo12": 1.0, "g1": 0.7, "talos": 0.7}


def draw(name: str) -> None:
    """Draw a robot in its scene, at its start."""
    with tempfile.TemporaryDirectory() as folder:
        if name in CLOSER:
            scene = load_scene(make_files(name, Path(folder) / name, 0).with_name("scene.yaml"))
            distance, look_at = CLOSER[name] * scene.camera.distance, scene.camera.look_at
        else:
            scene = load_scene(SCENES[name])
            distance, look_at = VIEWS[name]
        simulator = Simulator(scene)
        camera = dataclasses.replace(scene.camera, distance=distance, look_at=look_at)
        with Renderer(scene, SIZE, simulator.joint_names) as renderer:
            picture = Image.fromarray(renderer.draw(simulator.state().q, camera=camera))
    small = picture.resize((SIZE[0] // 2, SIZE[1] // 2), Image.Resampling.LANCZOS)
    FOLDER.mkdir(parents=True, exist_ok=True)
    small.quantize(128).save(FOLDER / f"{name}.png", optimize=True)


if __name__ == "__main__":
    install_model("icub-models")
    install_study_model("example-robot-data")
    for name in sys.argv[1:] or (*SCENES, *CLOSER):
        draw(name)
