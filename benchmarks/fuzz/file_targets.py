"""External files: robot, scene and scenario, URDF, truncated recordings."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

from hypothesis import strategies as st

from benchmarks.fuzz.target import FILE_BUDGET, Target, edited, mutated
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_sim_bridge import load_scene
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_reading import intact_records
from ghc_sim_bridge.recorder.bag_recording import BagRecording
from ghc_sim_bridge.scenario.scenario import find_scenario, load_scenario
from ghc_sim_bridge.scene.description import find_scene

WORDS = (
    "0", "-1", "1e300", ".nan", ".inf", "[]", "{}", "[1, 2]", "null", "true", "''", "-", ":",
    "&a", "*a", "!!python/object:os.system", "{a: b}", "tool", "joint_1", "kind:", "1000000",
)  # fmt: skip
TAGS = (
    "<link name='x'/>", "<joint/>", "</robot>", "type='prismatic'", "value='0'", "nan", "1e400",
    "<mimic joint='joint_1'/>", "&amp;", "&bomb;", "name='joint_1'", "<!--", "-->", "mass='-1'",
)  # fmt: skip


@cache
def folder() -> Path:
    """Where drafts are written; in memory, and gone with the process."""
    keeper = tempfile.TemporaryDirectory(prefix="ghc_fuzz_")
    _kept.append(keeper)
    (Path(keeper.name) / "kuka_lwr.urdf").write_bytes(
        find_robot("kuka_lwr").with_name("kuka_lwr.urdf").read_bytes()
    )
    return Path(keeper.name)


_kept: list[tempfile.TemporaryDirectory[str]] = []


def read_robot(text: str) -> None:
    """A robot.yaml beside its URDF."""
    path = folder() / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    load_robot_config(path)


def read_scene(text: str) -> None:
    """A scene."""
    path = folder() / "scene.yaml"
    path.write_text(text, encoding="utf-8")
    load_scene(path)


def read_scenario(text: str) -> None:
    """A scenario."""
    path = folder() / "scenario.yaml"
    path.write_text(text, encoding="utf-8")
    load_scenario(str(path))


def read_urdf(text: str) -> None:
    """A URDF below a sound robot.yaml."""
    place = folder() / "urdf"
    place.mkdir(exist_ok=True)
    (place / "kuka_lwr.urdf").write_text(text, encoding="utf-8")
    path = place / "robot.yaml"
    path.write_text(find_robot("kuka_lwr").read_text(encoding="utf-8"), encoding="utf-8")
    load_robot_config(path)


def read_recording(data: bytes) -> None:
    """A recording that was cut or overwritten."""
    path = folder() / "cut.mcap"
    path.write_bytes(data)
    for _ in intact_records(path):
        pass


def recording() -> bytes:
    """A small sound recording."""
    recorded = BagRecording(folder() / "sound")
    recorded.add_topic(BagTopic("/clock", "std_msgs/msg/String", "string data"))
    for i in range(20):
        recorded.write("/clock", i, i, bytes(40))
        if i % 10 == 9:
            recorded.checkpoint()
    recorded.close()
    return recorded.path.read_bytes()


def targets() -> tuple[Target, ...]:
    """All of this file."""
    text = {
        "robot": (find_robot("kuka_lwr").read_text(encoding="utf-8"),),
        "scene": tuple(
            find_scene(name).read_text(encoding="utf-8") for name in ("kuka_lwr", "kuka_lwr_plane")
        ),
        "scenario": tuple(
            find_scenario(name).read_text(encoding="utf-8")
            for name in ("priority_switching", "contact_force")
        ),
        "urdf": (find_robot("kuka_lwr").with_name("kuka_lwr.urdf").read_text(encoding="utf-8"),),
    }

    def of_files(kind: str, words: tuple[str, ...] = WORDS) -> st.SearchStrategy[str]:
        return edited(text[kind], words)

    return (
        Target("robot_file", of_files("robot"), read_robot, budget=FILE_BUDGET, share=0.03),
        Target("scene_file", of_files("scene"), read_scene, budget=FILE_BUDGET, share=0.03),
        Target(
            "scenario_file", of_files("scenario"), read_scenario, budget=FILE_BUDGET, share=0.03
        ),
        Target("urdf", of_files("urdf", TAGS), read_urdf, budget=FILE_BUDGET, share=0.03),
        Target(
            "recording", mutated((recording(),)), read_recording, budget=FILE_BUDGET, share=0.2
        ),
    )
