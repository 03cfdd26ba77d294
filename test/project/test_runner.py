"""The stand-in for `ros2 run`: finds what `ros2 run` finds, and says what there is otherwise."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tools import ros2_run

RUNNER = Path(ros2_run.__file__)


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An install prefix with one package `demo`, the only one in the ament index."""
    index = tmp_path / "share" / "ament_index" / "resource_index" / "packages"
    index.mkdir(parents=True)
    (index / "demo").touch()
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    monkeypatch.setattr(ros2_run, "_INSTALL", tmp_path)
    return tmp_path


def _add(path: Path, text: str = "#!/bin/sh\n", mode: int = 0o755) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    path.chmod(mode)
    return path


def _run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(RUNNER), *arguments], capture_output=True, text=True, check=False
    )


def test_finds_the_executable_in_a_subfolder_and_skips_hidden_ones(prefix: Path) -> None:
    path = _add(prefix / "lib" / "demo" / "inner" / "node")
    _add(prefix / "lib" / "demo" / ".hidden" / "node")
    _add(prefix / "lib" / "demo" / "not_executable", mode=0o644)
    assert ros2_run.resolve("demo", "node") == path
    with pytest.raises(ros2_run.RunError, match="has: node"):
        ros2_run.resolve("demo", "not_executable")


def test_an_ambiguous_name_is_refused(prefix: Path) -> None:
    for folder in ("a", "b"):
        _add(prefix / "lib" / "demo" / folder / "node")
    with pytest.raises(ros2_run.RunError, match="not unique"):
        ros2_run.resolve("demo", "node")


def test_an_unknown_package_lists_the_runnable_ones(prefix: Path) -> None:
    _add(prefix / "lib" / "demo" / "node")
    with pytest.raises(ros2_run.RunError, match=r"'nowhere' not found.*: demo$"):
        ros2_run.resolve("nowhere", "node")


def test_without_a_sourced_workspace_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("AMENT_PREFIX_PATH")
    with pytest.raises(ros2_run.RunError, match=r"source install/setup\.bash"):
        ros2_run.resolve("demo", "node")


def test_arguments_and_exit_code_are_those_of_the_executable(prefix: Path) -> None:
    _add(prefix / "lib" / "demo" / "node", '#!/bin/sh\nprintf "[%s]" "$@"\nexit 7\n')
    run = _run("demo", "node", "--ros-args", "-p", "text:=two words", "--help")
    assert run.stdout == "[--ros-args][-p][text:=two words][--help]"
    assert run.returncode == 7


@pytest.mark.parametrize("arguments", [(), ("ghc_controller",), ("nowhere", "node")])
def test_user_errors_are_one_line(arguments: tuple[str, ...]) -> None:
    run = _run(*arguments)
    assert run.returncode == ros2_run.USAGE_ERROR
    assert run.stdout == ""
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("package", "executable"),
    [
        ("ghc_controller", "controller"),
        ("ghc_sim_bridge", "sim_bridge"),
        ("ghc_sim_bridge", "experiment"),
        ("ghc_sim_bridge", "recorder"),
        ("ghc_sim_bridge", "viewer"),
        ("ghc_sim_bridge", "paper"),
    ],
)
def test_the_workspace_offers_its_executables(package: str, executable: str) -> None:
    path = ros2_run.resolve(package, executable)
    assert path.parts[-3:] == ("lib", package, executable)
