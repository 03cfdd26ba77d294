"""Robot models that come as packages: found by robot, pinned, installed only when asked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from ghc_controller.robot.library import list_robots
from tools import model_packages
from tools.workspace.errors import SetupError
from tools.workspace.layout import Layout

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the packages that would be installed."""
    names: list[str] = []
    monkeypatch.setattr(model_packages, "install_missing", lambda name, _: names.append(name))
    return names


@pytest.mark.parametrize("version", [(3, 11), (3, 12)])
def test_every_package_of_a_robot_is_pinned_by_hash(version: tuple[int, int]) -> None:
    text = Layout(ROOT).models_lock(version).read_text(encoding="utf-8")
    for package in model_packages.packages_of(list(list_robots())):
        block = text.partition(f"\n{package}==")[2]
        assert "--hash=sha256:" in block


def test_a_scenario_asks_for_the_model_of_its_robot_only(asked: list[str]) -> None:
    assert model_packages.main(["priority_switching"]) == 0
    assert asked == []
    assert model_packages.main(["--all"]) == 0
    assert asked == model_packages.packages_of(list(list_robots()))


def test_a_scenario_that_is_none_is_left_to_the_experiment(asked: list[str]) -> None:
    assert model_packages.main(["no_such_scenario"]) == 0
    assert asked == []


def test_a_package_that_is_there_is_not_installed_again() -> None:
    model_packages.install_missing("numpy", Layout(Path("/nowhere")))


def test_an_installation_that_fails_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(package: str, _: Layout) -> None:
        raise SetupError(f"the package '{package}' could not be installed")

    monkeypatch.setattr(model_packages, "install_missing", fail)
    assert model_packages.main(["--all"]) == 1
    assert capsys.readouterr().err.startswith("set-up: the package '")
