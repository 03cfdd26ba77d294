"""A small workspace for the tests of the set-up."""

from __future__ import annotations

from pathlib import Path

import pytest
from setup_doubles import FakeMachine, FakeRunner, touch

from tools.workspace.layout import Layout, Way
from tools.workspace.step import Context


@pytest.fixture
def layout(tmp_path: Path) -> Layout:
    """A small workspace with one message package and one Python package."""
    layout = Layout(tmp_path / "workspace")
    for name in ("uv.txt", "lock-py3.12.txt", "lock-noros-py3.12.txt"):
        touch(layout.root / "requirements" / name, name)
    for name in ("wheel_includes.cmake", "wheels_local_setup.sh"):
        touch(layout.root / "tools" / name)
    touch(layout.messages() / "msg" / "Something.msg", "float64 value\n")
    for name in ("setup.py", "setup.cfg", "package.xml", "pure/module.py"):
        touch(layout.source / "pure" / name)
    return layout


@pytest.fixture
def context(layout: Layout) -> Context:
    return Context(layout, Way.WHEELS, FakeMachine(), FakeRunner(layout), {"PATH": "/usr/bin"})
