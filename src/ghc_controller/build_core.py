"""Builds the extension of `ghc_controller/core` by CMake: the one way for pip and for colcon."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension
from setuptools.command.build_ext import build_ext

CORE = Extension("ghc_controller.core.native", sources=[])
SOURCE = Path(__file__).resolve().parent / "ghc_controller" / "core"


class BuildCore(build_ext):
    """Runs CMake on `ghc_controller/core/CMakeLists.txt` and puts its library where it belongs."""

    def build_extension(self, extension: Extension) -> None:
        """Build it; where GHC_CORE_BUILD names the CMake folder of a build, only link it."""
        target = Path(self.get_ext_fullpath(extension.name)).resolve()
        build = os.environ.get("GHC_CORE_BUILD") or Path(self.build_temp) / "core"
        build_core(Path(build).resolve(), target.parent)


def build_core(build: Path, target: Path) -> None:
    """Build in the folder `build`, and put the extension into the folder `target`.

    GHC_CMAKE_ARGS in the environment holds further options of CMake.
    """
    python, prefix = _python_with_nanobind()
    build.mkdir(parents=True, exist_ok=True)
    target.mkdir(parents=True, exist_ok=True)
    options = [
        f"-DPython_EXECUTABLE={python}",
        "-DCMAKE_BUILD_TYPE=Release",
        f"-DGHC_CORE_FOLDER={target}",
        *_generator(),
        *([f"-DEigen3_ROOT={prefix}"] if prefix else []),
        *os.environ.get("GHC_CMAKE_ARGS", "").split(),
    ]
    subprocess.run(["cmake", "-S", str(SOURCE), "-B", str(build), *options], check=True)
    subprocess.run(["cmake", "--build", str(build), "--parallel", "2"], check=True)


def _generator() -> list[str]:
    return ["-GNinja"] if shutil.which("ninja") else []


# Prints where a Python package brings Eigen's headers, if one does; CMake finds the system's.
_PROBE = """
import nanobind
from importlib.metadata import PackageNotFoundError, distribution
try:
    print(distribution("cmeel-eigen").locate_file("cmeel.prefix"))
except PackageNotFoundError:
    print()
"""


def _python_with_nanobind() -> tuple[str, str]:
    """The Python to build for, and the prefix of Eigen's headers ("": of the system).

    A colcon of the system runs this with the system's Python, while nanobind is in the virtual
    environment that is active.
    """
    pythons = [sys.executable]
    if "VIRTUAL_ENV" in os.environ:
        pythons.append(str(Path(os.environ["VIRTUAL_ENV"]) / "bin" / "python"))
    for python in pythons:
        probe = subprocess.run([python, "-c", _PROBE], capture_output=True, text=True, check=False)
        if probe.returncode == 0:
            return python, probe.stdout.strip()
    raise SystemExit(
        "the core of ghc_controller needs nanobind: activate the environment of `make setup`, or "
        "install requirements/build.in"
    )


if __name__ == "__main__":  # build_core.py FOLDER: built there, put beside the sources
    build_core(Path(sys.argv[1]).resolve(), SOURCE)
