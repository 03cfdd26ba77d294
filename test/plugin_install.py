"""Installs the package of `test/plugin_package` where one test sees it, never into the venv."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent / "plugin_package"


def install_plugin(folder: Path) -> Path:
    """`pip install --target` below `folder`; what it returns belongs on PYTHONPATH."""
    source, target = folder / "source", folder / "installed"
    shutil.copytree(PACKAGE, source)  # a build leaves files beside the sources
    options = ("--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check")
    command = [sys.executable, "-m", "pip", "install", *options, "--target", target, source]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return target


def on_python_path(folder: Path, patch: pytest.MonkeyPatch) -> None:
    """Processes started from now on import from `folder` first."""
    rest = os.environ.get("PYTHONPATH")
    patch.setenv("PYTHONPATH", os.pathsep.join([str(folder), *([rest] if rest else [])]))
