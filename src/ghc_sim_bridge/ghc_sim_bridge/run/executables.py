"""Finds installed executables through the ament index, as `ros2 run` does."""

from __future__ import annotations

import os
from pathlib import Path

from ghc_controller.errors import GhcError, UnknownName
from ghc_controller.migration.names import Kind, hint

_INDEX = Path("share", "ament_index", "resource_index", "packages")


def find_executable(package: str, executable: str) -> Path:
    """The executable file of that name below lib/<package>.

    Raises GhcError if the package is not in the ament index or the name is ambiguous,
    UnknownName if there is no such executable.
    """
    prefix = package_prefixes().get(package)
    if prefix is None:
        raise GhcError(
            f"package '{package}' is not in the ament index; build the workspace and "
            "source install/setup.bash"
        )
    there = executables(prefix, package)
    hits = [path for path in there if path.name == executable]
    if not hits:
        words = hint(Kind.EXECUTABLE, f"{package} {executable}")
        if words:
            raise GhcError(f"no executable '{executable}' in '{package}': {words}")
        raise UnknownName(
            f"executable of package '{package}'", executable, (path.name for path in there)
        )
    if len(hits) > 1:
        places = ", ".join(map(str, hits))
        raise GhcError(f"'{executable}' in '{package}' is not unique: {places}")
    return hits[0]


def executables(prefix: Path, package: str) -> list[Path]:
    """Executable files below lib/<package> of an install prefix, without hidden folders."""
    found = []
    for folder, inner, names in os.walk(prefix / "lib" / package):
        inner[:] = [name for name in inner if not name.startswith(".")]
        paths = (Path(folder) / name for name in names)
        found += [path for path in paths if path.is_file() and os.access(path, os.X_OK)]
    return sorted(found)


def package_prefixes() -> dict[str, Path]:
    """Package -> install prefix, of all packages in the ament index of this environment."""
    found: dict[str, Path] = {}
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        for entry in Path(prefix, _INDEX).glob("*"):
            found.setdefault(entry.name, Path(prefix))
    return found
