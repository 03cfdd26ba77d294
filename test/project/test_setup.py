"""The set-up: what it repeats and what it does not, after changes, interruptions and moves."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from setup_doubles import GOOD, FakeMachine, FakeRunner, touch

from tools.workspace import __main__ as program
from tools.workspace import checks
from tools.workspace.layout import Layout, Way
from tools.workspace.machine import Machine
from tools.workspace.run import Runner
from tools.workspace.stamps import Stamp, files_below, key_of
from tools.workspace.step import Context

ROOT = Path(__file__).resolve().parents[2]


def _ran(context: Context) -> list[str]:
    program.set_up(context)
    assert isinstance(context.run, FakeRunner)
    return context.run.kinds()


def test_a_second_set_up_runs_nothing(context: Context) -> None:
    assert _ran(context) == ["venv", "packages", "messages", "core", "python"]
    assert _ran(context) == []


def test_only_what_changed_is_made_again(context: Context) -> None:
    _ran(context)
    layout = context.layout
    touch(layout.source / "pure" / "pure" / "module.py", "# edited\n")
    assert _ran(context) == []  # installed by symlink
    touch(layout.source / "pure" / "setup.py", "# one more executable\n")
    assert _ran(context) == ["python"]
    touch(layout.messages() / "msg" / "Other.msg", "float64 value\n")
    assert _ran(context) == ["messages"]
    touch(layout.lock(Way.WHEELS, (3, 12)), "other versions")
    assert _ran(context) == ["packages", "messages"]


@pytest.mark.parametrize(
    ("word", "rest"),
    [
        (" -m venv", ["venv", "packages", "messages", "core", "python"]),
        ("uv pip install", ["packages", "messages", "core", "python"]),
        ("ghc_msgs", ["messages", "python"]),
        ("build_core.py", ["core", "python"]),
        ("pure", ["python"]),
    ],
)
def test_an_interrupted_set_up_goes_on(context: Context, word: str, rest: list[str]) -> None:
    assert isinstance(context.run, FakeRunner)
    context.run.failing = word
    with pytest.raises(KeyboardInterrupt):
        program.set_up(context)
    context.run.failing = ""
    context.run.kinds()
    assert _ran(context) == rest
    assert _ran(context) == []


def test_a_half_installed_package_is_installed_again(context: Context) -> None:
    """The installer takes a package for installed as soon as its metadata is there."""
    packages = context.layout.venv / "lib" / "python3.12" / "site-packages"
    _ran(context)
    touch(packages / "whole-1.dist-info" / "METADATA")
    touch(packages / "whole-1.dist-info" / "RECORD")
    touch(packages / "half-1.dist-info" / "METADATA")
    touch(context.layout.lock(Way.WHEELS, (3, 12)), "other versions")
    _ran(context)
    assert [path.name for path in packages.iterdir()] == ["whole-1.dist-info"]


@pytest.mark.parametrize("gone", ["build", "install"])
def test_what_was_removed_is_made_again(context: Context, gone: str) -> None:
    _ran(context)
    folder = context.layout.root / gone
    folder.rename(folder.with_name("elsewhere"))
    assert _ran(context) == ["messages", *(["core"] if gone == "build" else []), "python"]


def test_messages_that_went_leave_nothing_behind(context: Context) -> None:
    _ran(context)
    stale = context.layout.install / "ghc_msgs" / "stale.py"
    touch(stale)
    touch(context.layout.messages() / "msg" / "Something.msg", "float64[7] value\n")
    _ran(context)
    assert not stale.exists()


def test_a_fitting_environment_is_taken_over(context: Context) -> None:
    """One made by hand, of either supported version; not one of another version."""
    assert isinstance(context.run, FakeRunner)
    context.run(["python", "-m venv"], {}, "")
    context.run.kinds()
    assert _ran(context) == ["packages", "messages", "core", "python"]
    touch(context.layout.venv / "pyvenv.cfg", "version_info = 3.10.1\n")
    assert "venv" in _ran(context)


def test_a_moved_workspace_is_made_anew(context: Context) -> None:
    """Scripts of an environment hold its path."""
    _ran(context)
    moved = Layout(context.layout.root.with_name("moved"))
    context.layout.root.rename(moved.root)
    assert "venv" in _ran(replace(context, layout=moved, run=FakeRunner(moved)))


def test_a_sourced_installation_brings_its_ros(context: Context) -> None:
    """Then the lock without ROS is installed, over the system's packages; CMake needs no help."""
    assert isinstance(context.run, FakeRunner)
    machine = FakeMachine([replace(GOOD, path="/usr/bin/python3")], distribution="jazzy")
    assert checks.choose_way(machine) is Way.SYSTEM
    program.set_up(replace(context, way=Way.SYSTEM, machine=machine))
    text = "\n".join(context.run.commands)
    assert "/usr/bin/python3 -m venv --system-site-packages" in text
    assert "lock-noros-py3.12.txt" in text
    assert "wheel_includes" not in text
    assert "WITH_CPP" not in text  # its programs in C++ read the messages


def test_messages_and_core_are_built_side_by_side(context: Context) -> None:
    """Each is begun before the other one has ended."""

    class Meeting(FakeRunner):
        def __call__(
            self,
            command: Sequence[str],
            environment: Mapping[str, str],
            complaint: str,
            log: Path | None = None,
        ) -> None:
            if any(word in " ".join(command) for word in ("ghc_msgs", "build_core.py")):
                both_began.wait(timeout=60.0)
            super().__call__(command, environment, complaint, log)

    both_began = threading.Barrier(2)
    runner = Meeting(context.layout)
    program.set_up(replace(context, run=runner))
    assert runner.kinds() == ["venv", "packages", "messages", "core", "python"]


def test_the_core_is_built_anew_for_another_python_only(context: Context) -> None:
    """CMake refuses the cache of another place; an edit compiles what depends on it."""
    layout = context.layout
    _ran(context)
    cache = layout.core_build / "CMakeCache.txt"
    touch(cache)
    touch(layout.source / "pure" / "pyproject.toml", "# edited\n")
    assert _ran(context) == ["core"]
    assert cache.exists()
    touch(layout.venv / "pyvenv.cfg", "version = 3.12.9\n")
    assert "core" in _ran(context)
    assert not cache.exists()


def test_output_of_a_command_goes_to_its_log(tmp_path: Path) -> None:
    log = tmp_path / "log" / "one.log"
    Runner(tmp_path)(["sh", "-c", "echo out; echo err >&2"], {}, "", log)
    assert sorted(log.read_text(encoding="utf-8").split()) == ["err", "out"]


def test_a_key_depends_on_every_input(tmp_path: Path) -> None:
    touch(tmp_path / "a", "1")
    touch(tmp_path / "__pycache__" / "a.pyc", "1")
    assert files_below(tmp_path) == [tmp_path / "a"]
    key = key_of(files_below(tmp_path), (3, 12))
    assert key == key_of(files_below(tmp_path), (3, 12))
    assert key != key_of(files_below(tmp_path), (3, 11))
    touch(tmp_path / "a", "2")
    assert key != key_of(files_below(tmp_path), (3, 12))
    stamp = Stamp(tmp_path / "stamp")
    stamp.begin(key)
    assert stamp.is_begun(key)
    assert not stamp.is_done(key)
    stamp.done(key)
    assert stamp.is_begun(key)
    assert stamp.is_done(key)
    assert not stamp.is_begun("other")


def test_this_workspace_is_up_to_date_in_a_moment() -> None:
    """The real command on the workspace that the tests run in, by its own processor time."""
    context = Context(
        Layout(ROOT), checks.choose_way(Machine()), Machine(), Runner(ROOT), os.environ
    )
    kinds = [kind for group in program.STEPS for kind in group]
    assert [kind.title for kind in kinds if not kind(context).is_done()] == []
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run(
        [sys.executable, "-m", "tools.workspace"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert "up to date" in run.stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 1.0  # [s]
