"""Models by name: of robot_descriptions if cached, of a sourced ROS package, postures of SRDF."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
import yaml

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.first_files.new_robot import main
from ghc_controller.robot.library import find_robot, load_robot
from ghc_controller.robot.urdf import find_urdf
from ghc_controller.robot.urdf_text import resource_path

ROBOT = Path("some/robot.yaml")
URDF = "<robot name='toy'/>"
# What a module of the package is: the first lines that ask for the clone, then paths.
MODULE = """
from ._cache import clone_to_cache as _clone_to_cache
REPOSITORY_PATH: str = _clone_to_cache(
    "{repository}",
    commit=None,
)
{kind}_PATH: str = REPOSITORY_PATH + "/toy/model.{ending}"
"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An installed robot_descriptions, as far as it is used, and its empty cache."""
    package = tmp_path / "site" / "robot_descriptions"
    package.mkdir(parents=True)
    folder = tmp_path / "cache"
    files = {
        "__init__": "",
        "_cache": f"def clone_to_cache(name, commit):\n    return '{folder}/' + name\n",
        "_repositories": (
            "from types import SimpleNamespace\n"
            "REPOSITORIES = {name: SimpleNamespace(cache_path=name)"
            " for name in ('example-robot-data', 'mujoco_menagerie')}\n"
        ),
        "toy_description": MODULE.format(
            repository="example-robot-data", kind="URDF", ending="urdf"
        ),
        "toy_mj_description": MODULE.format(
            repository="mujoco_menagerie", kind="MJCF", ending="urdf"
        ),
    }
    for name, text in files.items():
        (package / f"{name}.py").write_text(text, encoding="utf-8")
    for name in [name for name in sys.modules if name.startswith("robot_descriptions")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.syspath_prepend(str(package.parent))
    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(folder))
    return folder


@pytest.mark.parametrize(
    ("name", "repository"),
    [("toy_description", "example-robot-data"), ("toy_mj_description", "mujoco_menagerie")],
)
def test_a_description_in_the_cache_is_used(cache: Path, name: str, repository: str) -> None:
    file = cache / repository / "toy" / "model.urdf"
    file.parent.mkdir(parents=True)
    file.write_text(URDF, encoding="utf-8")
    assert find_urdf({"description": name}, ROBOT) == file


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("toy_description", ["cache/example-robot-data' is missing", "pip install example-robot"]),
        (
            "toy_mj_description",
            ["cache/mujoco_menagerie' is missing", "mujoco-menagerie`"],
        ),
        ("moon_description", ["'moon_description': robot_descriptions has no such name"]),
        ("not a name", ["'not a name': robot_descriptions has no such name"]),
    ],
)
def test_without_the_cache_nothing_is_downloaded_and_the_message_says_what_to_do(
    cache: Path, name: str, words: list[str]
) -> None:
    with pytest.raises(ConfigurationError) as error:
        find_urdf({"description": name}, ROBOT)
    assert all(word in str(error.value) for word in ["some/robot.yaml: urdf: ", *words])
    assert not cache.exists()


def test_without_the_package_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ghc_controller.robot.descriptions.find_spec", lambda _: None)
    with pytest.raises(ConfigurationError, match="pip install robot_descriptions"):
        find_urdf({"description": "toy_description"}, ROBOT)


@pytest.mark.parametrize("given", [{"file": "a.urdf", "description": "toy"}, {"root": "base"}])
def test_either_a_file_or_a_description_is_given(given: dict[str, str]) -> None:
    with pytest.raises(ConfigurationError, match=r"urdf.file: a file or a description expected"):
        find_urdf(given, ROBOT)


@pytest.mark.parametrize(
    ("variable", "share"), [("AMENT_PREFIX_PATH", "share"), ("ROS_PACKAGE_PATH", "")]
)
def test_a_package_uri_is_looked_for_in_the_sourced_ros_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, variable: str, share: str
) -> None:
    file = tmp_path / share / "toy_description" / "urdf" / "toy.urdf"
    file.parent.mkdir(parents=True)
    file.write_text(URDF, encoding="utf-8")
    monkeypatch.setenv(variable, f"/nowhere:{tmp_path}")
    uri = "package://toy_description/urdf/toy.urdf"
    assert find_urdf(uri, ROBOT) == resource_path(uri, Path("/else/where.urdf")) == file


SRDF = """<robot name="arm">
  <group_state name="home" group="arm"><joint name="joint_2" value="0.3"/></group_state>
  <group_state name="ready" group="arm"><joint name="joint_2" value="0.4"/>
    <joint name="joint_4" value="1.2"/><joint name="finger" value="1"/></group_state>
</robot>"""


@pytest.mark.parametrize(
    ("options", "second", "fourth"), [([], 0.4, 1.2), (["--pose", "home"], 0.3, 0.0)]
)
def test_a_group_state_of_an_srdf_is_the_start(
    tmp_path: Path, options: list[str], second: float, fourth: float
) -> None:
    srdf = tmp_path / "arm.srdf"
    srdf.write_text(SRDF, encoding="utf-8")
    urdf = next(find_robot("kuka_lwr").parent.glob("*.urdf"))
    folder = tmp_path / "arm"
    assert main([str(urdf), "--folder", str(folder), "--srdf", str(srdf), *options]) == 0
    start = yaml.safe_load((folder / "scene.yaml").read_text(encoding="utf-8"))["start"]
    expected = dict.fromkeys(load_robot(folder).model.joint_names, 0.0)
    expected |= {"joint_2": second, "joint_4": fourth}
    assert start == pytest.approx(expected)


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        (SRDF, ["--pose", "sit"], "unknown group state of .*'sit'; known: home, ready"),
        ("<robot/>", [], "no group_state of a joint of the robot"),
        ("no xml", [], "cannot be read as an SRDF"),
        (SRDF.replace("0.4", "up"), [], "joint 'joint_2': a number expected, 'up' given"),
    ],
)
def test_an_srdf_that_cannot_be_used_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, options: list[str], words: str
) -> None:
    srdf = tmp_path / "arm.srdf"
    srdf.write_text(text, encoding="utf-8")
    urdf = next(find_robot("kuka_lwr").parent.glob("*.urdf"))
    folder = tmp_path / "arm"
    assert main([str(urdf), "--folder", str(folder), "--srdf", str(srdf), *options]) == 1
    assert re.search(words, capsys.readouterr().err)
    assert not folder.exists()
