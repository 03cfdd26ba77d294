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


def executables(prefix: Path, package: str) -> list[Path]:
    """Executable files below lib/<package> of an install prefix; hidden folders do not count."""
    found = []
    for folder, inner, names in os.walk(prefix / "lib" / package):
        inner[:] = [name for name in inner if not name.startswith(".")]
        paths = (Path(folder) / name for name in names)
        found += [path for path in paths if path.is_file() and os.access(path, os.X_OK)]
    return sorted(found)


def resolve(package: str, executable: str) -> Path:
    """The file behind a package and an executable; RunError when there is not exactly one."""
    from ament_index_python import get_packages_with_prefixes

    try:
        prefixes = get_packages_with_prefixes()
    except OSError as error:  # AMENT_PREFIX_PATH is not set
        raise RunError(f"{error}; source install/setup.bash first") from error
    if package not in prefixes:
        raise RunError(
            f"package '{package}' not found; packages of this workspace with executables: "
            f"{_listed(_runnable(prefixes))}"
        )
    there = executables(Path(prefixes[package]), package)
    hits = [path for path in there if path.name == executable]
    if not hits:
        names = [path.name for path in there]
        raise RunError(f"no executable '{executable}' in '{package}'; it has: {_listed(names)}")
    if len(hits) > 1:
        raise RunError(
            f"'{executable}' in '{package}' is not unique: {_listed(list(map(str, hits)))}"
        )
    return hits[0]


def _runnable(prefixes: dict[str, str]) -> list[str]:
    """Packages of this workspace that can be run; the underlay has dozens more."""
    return [
        name
        for name, prefix in sorted(prefixes.items())
        if Path(prefix).is_relative_to(_INSTALL) and executables(Path(prefix), name)
    ]


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
