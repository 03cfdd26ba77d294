"""`ros2 run` for a machine without ros2cli: `python tools/ros2_run.py PACKAGE EXECUTABLE [ARGS]`.

Resolves as `ros2 run` does: the package by the ament index, then the one executable file of that
name below lib/<package>. This process becomes that executable, arguments untouched, so that its
signals and exit code are its own.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

USAGE_ERROR = 2
_INSTALL = Path(__file__).resolve().parents[1] / "install"


class RunError(Exception):
    """What was asked for is not there; the text names what is."""


def resolve(package: str, executable: str) -> Path:
    """The file behind a package and an executable; RunError when there is not exactly one."""
    try:
        from ghc_controller.errors import GhcError, UnknownName
        from ghc_sim_bridge.run.executables import executables, find_executable, package_prefixes
    except ModuleNotFoundError as error:
        raise RunError(f"{error}; source install/setup.bash first") from error

    prefixes = package_prefixes()
    if not prefixes:
        raise RunError("AMENT_PREFIX_PATH is not set; source install/setup.bash first")
    if package not in prefixes:
        # Only those of this workspace: the underlay has dozens more.
        own = {name: path for name, path in prefixes.items() if path.is_relative_to(_INSTALL)}
        runnable = sorted(name for name, path in own.items() if executables(path, name))
        raise RunError(
            f"package '{package}' not found; packages of this workspace with executables: "
            f"{_listed(runnable)}"
        )
    try:
        return find_executable(package, executable)
    except UnknownName as error:
        there = _listed(list(error.known))
        raise RunError(f"no executable '{executable}' in '{package}'; it has: {there}") from error
    except GhcError as error:
        raise RunError(str(error)) from error


def _listed(names: list[str]) -> str:
    return ", ".join(names) if names else "none"


def main(arguments: list[str]) -> int:
    """Become the executable; returns only when that was not possible."""
    if len(arguments) < 2 or arguments[0].startswith("-"):
        print("usage: ros2_run.py PACKAGE EXECUTABLE [ARGUMENTS]", file=sys.stderr)
        return USAGE_ERROR
    package, executable, *rest = arguments
    try:
        path = str(resolve(package, executable))
        os.execv(path, [path, *rest])
    except (RunError, OSError) as error:
        print(f"ros2_run: {error}", file=sys.stderr)
        return USAGE_ERROR


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
