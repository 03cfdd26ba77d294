"""Files of robots, scenes and scenarios, in the forms in which a registry holds them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from ghc_controller.errors import PluginError
from ghc_controller.registry import source_of

Files = str | Path | ModuleType | Callable[[], str | Path]


def made(source: object) -> object:
    """The source itself, or what it returns where it is a function.

    Raises:
        PluginError: the function raised.
    """
    if not callable(source):
        return source
    try:
        return source()
    except Exception as error:  # whatever a function of another package raises
        raise PluginError(
            f"{source_of(source)} failed: {type(error).__name__}: {error}"
        ) from error


def plugged_file(files: object, default: str) -> Path:
    """File of a robot, scene or scenario, as a registry holds it.

    Args:
        files: a package whose folder holds the file, the path of the file or its folder, or a
            function without arguments that returns such a path.
        default: name of the file in a folder.

    Raises:
        PluginError: there is no such file, or it is given in another form.
    """
    found = made(files)
    if isinstance(found, ModuleType):
        candidates = [Path(folder) / default for folder in getattr(found, "__path__", ())]
    elif isinstance(found, str | Path):
        path = Path(found).expanduser()
        candidates = [path / default if path.is_dir() else path]
    else:
        candidates = []
    if not candidates:
        raise PluginError(
            f"{found!r} given: a package, a path or a function that returns a path expected"
        )
    for file in candidates:
        if file.is_file():
            return file
    raise PluginError(f"file '{candidates[0]}' does not exist")
