"""Installed executables, found through the ament index."""

from __future__ import annotations

import os
from pathlib import Path

from ghc_controller.errors import GhcError, UnknownName

_INDEX = Path("share", "ament_index", "resource_index", "packages")


def find_executable(package: str, executable: str) -> Path:
    """Installed executable of a package, resolved as `ros2 run` does.

    Raises GhcError when the package is not in the ament index, UnknownName for the executable.
    """
    prefix = _prefix(package)
    if prefix is None:
        raise GhcError(
            f"package '{package}' is not in the ament index; build the workspace and "
            "source install/setup.bash"
        )
    folder = prefix / "lib" / package
    candidates = sorted(folder.iterdir()) if folder.is_dir() else []
    runnable = [path for path in candidates if path.is_file() and os.access(path, os.X_OK)]
    for path in runnable:
        if path.name == executable:
            return path
    raise UnknownName(
        f"executable of package '{package}'", executable, (path.name for path in runnable)
    )


def _prefix(package: str) -> Path | None:
    """First prefix of the environment in which the package is installed; None if in none."""
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    for prefix in map(Path, filter(None, prefixes)):
        if (prefix / _INDEX / package).is_file():
            return prefix
    return None
