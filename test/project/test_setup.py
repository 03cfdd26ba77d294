"""The set-up: what it repeats and what it does not, after changes, interruptions and moves."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
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
    assert _ran(context) == ["venv", "packages", "messages", "python"]
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
        (" -m venv", ["venv", "packages", "messages", "python"]),
        ("uv pip install", ["packages", "messages", "python"]),
        ("ghc_msgs", ["messages", "python"]),
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
    assert _ran(context) == ["messages", "python"]


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
    assert _ran(context) == ["packages", "messages", "python"]
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
    assert [kind.title for kind in program.STEPS if not kind(context).is_done()] == []
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
