"""A URDF beside robot.yaml or in a Python package; what is missing is named with the remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.urdf import find_urdf, package_of
from ghc_controller.robot.urdf_text import resource_path

ROBOT = Path("some/robot.yaml")
ENTRY = {"package": "toy-models", "file": "share/toy/robots/one/model.urdf"}


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of models as pip installs it: data below a prefix, its modules elsewhere."""
    site = tmp_path / "lib" / "site"
    data = tmp_path / "share" / "toy"
    for file in ("robots/one/model.urdf", "robots/two/model.urdf", "meshes/arm.stl"):
        (data / file).parent.mkdir(parents=True, exist_ok=True)
        (data / file).write_text("<robot name='toy'/>", encoding="utf-8")
    metadata = site / "toy_models-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Name: toy-models\nVersion: 1.0\n", encoding="utf-8")
    files = ("one/model.urdf", "two/model.urdf")
    record = "".join(f"../../share/toy/robots/{file},,\n" for file in files)
    (metadata / "RECORD").write_text(record, encoding="utf-8")
    monkeypatch.syspath_prepend(str(site))
    return data


def test_a_path_is_relative_to_the_robot_file() -> None:
    assert find_urdf("arm.urdf", ROBOT) == Path("some/arm.urdf")
    assert find_urdf("/other/arm.urdf", ROBOT) == Path("/other/arm.urdf")
    assert package_of("arm.urdf", ROBOT) == ""


def test_a_file_of_a_package_is_found_where_it_was_installed(package: Path) -> None:
    assert find_urdf(ENTRY, ROBOT) == package / "robots" / "one" / "model.urdf"
    assert package_of(ENTRY, ROBOT) == "toy-models"


def test_meshes_of_a_package_are_found_above_its_urdf(package: Path) -> None:
    urdf = find_urdf(ENTRY, ROBOT)
    assert resource_path("package://toy/meshes/arm.stl", urdf) == package / "meshes" / "arm.stl"
    assert resource_path("arm.stl", urdf) == urdf.parent / "arm.stl"
    assert not resource_path("package://toy/meshes/leg.stl", urdf).exists()


def test_a_package_that_is_missing_is_named_with_how_to_get_it() -> None:
    with pytest.raises(ConfigurationError) as caught:
        find_urdf({"package": "no-such-models", "file": "a.urdf"}, ROBOT)
    text = str(caught.value)
    assert text.startswith("some/robot.yaml: urdf: ")
    assert "'no-such-models', which is not installed" in text
    assert "pip install no-such-models" in text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (ENTRY | {"file": "share/toy/three.urdf"}, "'toy-models' has no file 'share/toy/three"),
        (None, "the path of a file, or {package: name, file: path} expected, None given"),
        ("", "'' given"),
        ({"package": "toy-models"}, "urdf.file: a file or a description expected"),
        (ENTRY | {"file": 3}, "urdf.file: a non-empty text expected, 3 given"),
    ],
)
def test_what_is_no_urdf_is_refused_in_one_line(
    package: Path, entry: object, message: str
) -> None:
    assert package.is_dir()
    with pytest.raises(ConfigurationError) as caught:
        find_urdf(entry, ROBOT)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
